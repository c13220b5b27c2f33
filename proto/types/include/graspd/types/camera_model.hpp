#pragma once

#include <Eigen/Core>

#include "graspd/types/frame.hpp"

/// The pinhole camera with OpenCV's distortion (k1, k2, p1, p2, k3), both ways.
namespace graspd {

/// The image point of `p_camera_m`, in pixels; any z above 0.
Eigen::Vector2d project(const CameraIntrinsics& camera, const Eigen::Vector3d& p_camera_m);

/// The point at z = 1 on the ray through an image point, without distortion. Times a depth reading
/// it is the point that was seen.
Eigen::Vector3d ray_through(const CameraIntrinsics& camera, double u_px, double v_px);

}  // namespace graspd
