#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/pick_point.hpp"
#include "graspd/parts/symmetries.hpp"

namespace graspd::parts {

/// The turns that a pick point is repeated by, the identity first: the discrete symmetries, times
/// 24 steps about a continuous axis; of a ball those of the icosahedron.
std::vector<Eigen::Isometry3d> turns_of(const Symmetries& symmetries);

/// Whether the gripper does the same at both: jaws may change places, and a cup may turn about its
/// approach.
bool is_same_grasp(const PickPoint& a, const PickPoint& b);

/// The point and its images, no two of them the same grasp.
std::vector<PickPoint> images_of(const PickPoint& point,
                                 const std::vector<Eigen::Isometry3d>& turns);

}  // namespace graspd::parts
