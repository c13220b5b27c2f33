#include "graspd/perception/bowed_walls.hpp"

#include <algorithm>

namespace graspd::perception {

float BowedWalls::share_at(const Eigen::Vector3f& p_camera_m) const {
  const Eigen::Vector3f p_m = T_bin_camera * p_camera_m;
  const float distance_m = (half_size_m - p_m.head<2>().array().abs()).minCoeff();
  if (distance_m < 0) return 0;  // the rim and what is outside
  const float nearness = std::max(0.0F, 1 - distance_m / reach_m);
  return nearness * nearness;
}

BowedWalls bowed_walls(const Eigen::Isometry3d& T_camera_bin, const Eigen::Vector3d& inner_size_m,
                       double reach_m) {
  return {T_camera_bin.inverse().cast<float>(), inner_size_m.head<2>().cast<float>().array() / 2,
          static_cast<float>(reach_m)};
}

void straighten(DepthGrid& grid, const BowedWalls& walls, double bow_m) {
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      float& z_m = grid.z_m[grid.index(u, v)];
      if (z_m > 0) z_m += static_cast<float>(bow_m) * walls.share_at(grid.point_m(u, v));
    }
  }
}

}  // namespace graspd::perception
