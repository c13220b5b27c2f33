#pragma once

#include "graspd/motion/arm_model.hpp"
#include "graspd/parts/mesh.hpp"

namespace graspd::sim_cell {

/// A primitive to draw, about its own origin.
parts::Mesh mesh_of(const motion::Shape& shape);

}  // namespace graspd::sim_cell
