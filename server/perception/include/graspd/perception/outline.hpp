#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::perception {

/// The silhouette of a mesh in the image: u, v, u, v, … in pixels, closed, simplified to about half
/// a pixel; empty where nothing of it is in the image. The outer contour alone.
std::vector<float> outline_px(const CameraIntrinsics& camera, const parts::Mesh& mesh,
                              const Eigen::Isometry3d& T_camera_part);

}  // namespace graspd::perception
