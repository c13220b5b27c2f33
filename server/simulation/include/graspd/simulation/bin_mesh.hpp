#pragma once

#include "graspd/parts/mesh.hpp"

namespace graspd::simulation {

/// Four walls on a table, in the bin's frame: the table's top is the bin's floor.
parts::Mesh bin_mesh(const Eigen::Vector3d& inner_size_m, double wall_m);

}  // namespace graspd::simulation
