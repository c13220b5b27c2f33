#pragma once

#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// How thick the solid is under points evenly over its surface: along the
/// inward normal, to where it ends. In no order. \param mesh closed.
std::vector<double> wall_thicknesses_m(const Mesh& mesh);

}  // namespace graspd::parts
