#pragma once

#include <vector>

#include "graspd/parts/part.hpp"

namespace graspd::parts {

/// The description's pick points with the widths that it leaves out, measured on the mesh.
/// \returns INVALID_ARGUMENT with a line for each that contradicts the mesh: outside of it, nothing
/// between the jaws or below the cup, not midway between the jaws, not as wide as it says.
Result<std::vector<PickPoint>> taught_pick_points(const PartDescription& description,
                                                  const Mesh& mesh);

}  // namespace graspd::parts
