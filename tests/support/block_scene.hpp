#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "graspd/parts/catalogue.hpp"
#include "graspd/types/camera_model.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

/// Scenes that can be written down by hand: boxes over a plane, seen by a camera that looks
/// straight down, rendered by intersecting rays with boxes.
namespace graspd::testing {

inline CameraIntrinsics kinect_v2() { return {512, 424, 365.5, 365.5, 255, 205, {}}; }

inline parts::Part block_part(const std::string& id, const Eigen::Vector3d& size_m,
                              double spacing_m = 0.002) {
  parts::Part part;
  part.id = id;
  part.name = id;
  part.bop_obj_id = 1;
  part.diameter_m = size_m.norm();
  // Principal axes are x, y, z where the size falls in this order.
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    part.surface_area_m2 += 2 * size_m[a] * size_m[b];
    const int steps_a = static_cast<int>(size_m[a] / spacing_m);
    const int steps_b = static_cast<int>(size_m[b] / spacing_m);
    for (const int side : {-1, 1}) {
      for (int i = 0; i <= steps_a; ++i) {
        for (int j = 0; j <= steps_b; ++j) {
          Eigen::Vector3d p;
          p[axis] = side * size_m[axis] / 2;
          p[a] = (static_cast<double>(i) / steps_a - 0.5) * size_m[a];
          p[b] = (static_cast<double>(j) / steps_b - 0.5) * size_m[b];
          Eigen::Vector3f n = Eigen::Vector3f::Zero();
          n[axis] = static_cast<float>(side);
          part.surface.push_back({p.cast<float>(), n});
        }
      }
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    part.mesh.vertices_m.emplace_back(
        static_cast<float>(((corner & 1) != 0 ? 0.5 : -0.5) * size_m.x()),
        static_cast<float>(((corner & 2) != 0 ? 0.5 : -0.5) * size_m.y()),
        static_cast<float>(((corner & 4) != 0 ? 0.5 : -0.5) * size_m.z()));
  }
  part.mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  part.radius_m = part.diameter_m / 2;
  part.triangles = parts::TriangleGroups(part.mesh);
  part.contact = parts::ContactModel(part.surface);
  part.registration = parts::RegistrationModel(part.mesh, part.symmetries);
  return part;
}

struct Block {
  Eigen::Isometry3d T_camera_block = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};

/// Distance along the ray to the box, or nothing where it passes by (slab method).
inline std::optional<double> hit(const Block& block, const Eigen::Vector3d& ray_camera) {
  const Eigen::Isometry3d T_block_camera = block.T_camera_block.inverse();
  const Eigen::Vector3d origin = T_block_camera.translation();
  const Eigen::Vector3d direction = T_block_camera.linear() * ray_camera;
  double enter = 0;
  double leave = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    double a = (-block.size_m[axis] / 2 - origin[axis]) / direction[axis];
    double b = (block.size_m[axis] / 2 - origin[axis]) / direction[axis];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (enter > leave) return std::nullopt;
  return enter;
}

/// A floor at `floor_z_m` square to the optical axis, and blocks on or above it.
inline DepthFrame render(const CameraIntrinsics& camera, double floor_z_m,
                         const std::vector<Block>& blocks) {
  DepthFrame frame{camera, 0.001, {}};
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector3d ray = ray_through(camera, u, v);  // z = 1: distance is depth
      double z_m = floor_z_m;
      for (const Block& block : blocks) z_m = std::min(z_m, hit(block, ray).value_or(z_m));
      frame.depth.push_back(static_cast<std::uint16_t>(std::lround(z_m * 1000)));
    }
  }
  return frame;
}

/// Base on the floor below the camera, z up, x as the camera's.
inline Eigen::Isometry3d T_base_camera_above(double height_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  T.translation().z() = height_m;
  return T;
}

}  // namespace graspd::testing
