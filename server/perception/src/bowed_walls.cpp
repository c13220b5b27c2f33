#include "graspd/perception/bowed_walls.hpp"

#include <algorithm>
#include <cmath>

#include "parallel.hpp"

namespace graspd::perception {
namespace {

/// As `BowedWalls::share_at`, in operations that a compiler makes vectors of.
inline float share_of_bow(const BowedWalls& walls, const Eigen::Vector3f& p_camera_m) {
  const Eigen::Vector3f p_m = walls.T_bin_camera * p_camera_m;
  const float distance_m = std::min(walls.half_size_m.x() - std::abs(p_m.x()),
                                    walls.half_size_m.y() - std::abs(p_m.y()));
  const float nearness = std::max(0.0F, 1 - distance_m / walls.reach_m);
  return distance_m < 0 ? 0 : nearness * nearness;  // the rim and what is outside
}

}  // namespace

float BowedWalls::share_at(const Eigen::Vector3f& p_camera_m) const {
  return share_of_bow(*this, p_camera_m);
}

BowedWalls bowed_walls(const Eigen::Isometry3d& T_camera_bin, const Eigen::Vector3d& inner_size_m,
                       double reach_m) {
  return {T_camera_bin.inverse().cast<float>(), inner_size_m.head<2>().cast<float>().array() / 2,
          static_cast<float>(reach_m)};
}

void straighten(DepthGrid& grid, const BowedWalls& walls, double bow_m) {
  const auto width = static_cast<std::size_t>(grid.width_px);
  std::vector<float> ray_x(width);
  for (std::size_t u = 0; u < width; ++u) {
    ray_x[u] = (static_cast<float>(u) - grid.cx_px) / grid.fx_px;
  }
  parallel_for(static_cast<std::size_t>(grid.height_px), [&](std::size_t v) {
    const float ray_y = (static_cast<float>(v) - grid.cy_px) / grid.fy_px;
    // So that no write to the image can be one to the walls.
    const BowedWalls own = walls;  // NOLINT(performance-unnecessary-copy-initialization)
    const auto bow = static_cast<float>(bow_m);
    const float* x = ray_x.data();
    float* z_m = &grid.z_m[v * width];
    for (std::size_t u = 0; u < width; ++u) {
      const float z = z_m[u];
      const float straight = z + bow * share_of_bow(own, {x[u] * z, ray_y * z, z});
      z_m[u] = z > 0 ? straight : z;
    }
  });
}

}  // namespace graspd::perception
