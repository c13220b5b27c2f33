#pragma once

#include <Eigen/Geometry>

#include "graspd/perception/pose_kernel.hpp"

namespace graspd::perception {

inline KernelPose kernel_pose(const Eigen::Isometry3d& T) {
  KernelPose pose{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.R[3 * i + j] = static_cast<float>(T(i, j));
    pose.t_m[i] = static_cast<float>(T(i, 3));
  }
  return pose;
}

}  // namespace graspd::perception
