#pragma once

#include <vector>

#include "graspd/types/camera_model.hpp"

namespace graspd::simulation {

/// The points at z = 1 that the pixels look at, row by row, distortion undone.
std::vector<Eigen::Vector3d> pixel_rays(const CameraIntrinsics& camera);

/// The rectified image with `rays_per_side_n` pixels for each of the camera's that covers all of
/// its rays, each by at least a pixel of the camera.
CameraIntrinsics rectified_camera(const CameraIntrinsics& camera,
                                  const std::vector<Eigen::Vector3d>& rays, int rays_per_side_n);

}  // namespace graspd::simulation
