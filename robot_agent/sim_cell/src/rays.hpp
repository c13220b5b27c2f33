#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspd/types/frame.hpp"

namespace graspd::sim_cell {

/// (x/z, y/z) of the ray of each pixel, row by row, distortion undone.
std::vector<Eigen::Vector2d> pixel_rays(const CameraIntrinsics& camera);

/// The rectified image with `rays_per_side_n` pixels for each of the camera's that covers all of
/// its rays. A ray (x, y) is at pixel (fx x + cx, fy y + cy) of it, never nearer to its border than
/// a pixel of the camera.
CameraIntrinsics rectified_camera(const CameraIntrinsics& camera,
                                  const std::vector<Eigen::Vector2d>& rays, int rays_per_side_n);

inline Eigen::Vector2d project(const CameraIntrinsics& rectified, const Eigen::Vector2d& ray) {
  return {rectified.fx_px * ray.x() + rectified.cx_px, rectified.fy_px * ray.y() + rectified.cy_px};
}

}  // namespace graspd::sim_cell
