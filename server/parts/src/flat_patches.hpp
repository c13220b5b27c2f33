#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "triangle_tree.hpp"

namespace graspd::parts {

/// Where the seal of a suction cup closes, reached straight from outside.
struct FlatPatch {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d normal;  ///< unit, outwards
  double radius_m = 0;  ///< of the largest disc that is flat, or as gently curved as a lip follows
};

/// \returns nothing where the disc is smaller than the smallest cups'.
std::optional<FlatPatch> flat_patch_at(const TriangleTree& tree, const Eigen::Vector3d& centre_m,
                                       const Eigen::Vector3d& normal);

/// About points evenly over the surface.
std::vector<FlatPatch> flat_patches(const Mesh& mesh, const TriangleTree& tree);

}  // namespace graspd::parts
