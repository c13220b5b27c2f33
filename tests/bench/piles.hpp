#pragma once

#include "graspd/parts/catalogue.hpp"
#include "graspd/simulation/scene.hpp"

/// What the benches of perception plan on.
namespace graspd::bench {

/// Frames of one kind of part in our bin, the camera straight above it.
simulation::SceneOptions pile_of(const parts::Part& part, int parts_n,
                                 double camera_height_m = 0.75);

}  // namespace graspd::bench
