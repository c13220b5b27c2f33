#pragma once

#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/sim_cell/scene.hpp"

/// What the benches of perception plan on.
namespace graspd::bench {

/// The defaults on a cell where the sensor's bend at the bin's walls was measured on the empty bin.
perception::Parameters calibrated(const sim_cell::KinectV2Parameters& sensor,
                                  perception::Parameters parameters = {});

/// Frames of one kind of part in our bin, the camera straight above it.
sim_cell::SceneOptions pile_of(const parts::Part& part, int parts_n, double camera_height_m = 0.75);

}  // namespace graspd::bench
