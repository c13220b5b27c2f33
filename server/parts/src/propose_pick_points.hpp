#pragma once

#include <vector>

#include "graspd/parts/part.hpp"

namespace graspd::parts {

/// Pick points from the mesh alone, so that a new part needs no teaching: for parallel jaws
/// antipodal pairs ("antipodal_1", …), for cups flat patches ("flat_1", …), best first. Spread over
/// the part, of places that its symmetries lay over each other one: `images_of` makes the others.
/// The priority is a quality from 0 to 1. Nothing is random: one part has the same on every run.
/// \param part its mesh, surface, symmetries and what else is derived from the mesh.
std::vector<PickPoint> propose_pick_points(const Part& part);

}  // namespace graspd::parts
