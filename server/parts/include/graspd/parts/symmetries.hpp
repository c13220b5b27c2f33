#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// The part looks the same after any turn about this axis.
struct ContinuousSymmetry {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
};

/// How a part may be turned and still look the same, in its own frame.
struct Symmetries {
  /// T_part_part′: moves the part onto itself. Without the identity.
  std::vector<Eigen::Isometry3d> discrete;
  std::vector<ContinuousSymmetry> continuous;  ///< two: any turn about the point where they meet
};

/// The turns that lay the mesh's surface over itself to within 1 % of its diameter; the discrete
/// ones are a group. One mesh has the same on every machine.
Symmetries find_symmetries(const Mesh& mesh);

}  // namespace graspd::parts
