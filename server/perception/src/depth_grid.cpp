#include "graspd/perception/depth_grid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "graspd/types/camera_model.hpp"

namespace graspd::perception {
namespace {

/// Around what may be a part: readings there refute poses that reach beyond.
constexpr int kMargin_px = 12;
/// A cell belongs to the parts where a point of theirs lies within a pixel, about as deep.
constexpr float kSameSurface_m = 0.03F;
constexpr int kNormalReach_px = 3;
constexpr float kNormalStep_m = 0.008F;  ///< farther than this is another surface
constexpr int kNormalMinCells = 12;

constexpr std::uint32_t kInFront = 1;  // nearer than any reading
constexpr int kHighBits = 16;

struct Box {
  int u_first, v_first, u_last, v_last;
};

Box covering(const CameraIntrinsics& camera, const Cloud& cloud) {
  Box box{camera.width_px, camera.height_px, -1, -1};
  for (const auto& p : cloud.points_m) {
    const Eigen::Vector2d pixel = project(camera, p.cast<double>());
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    box = {std::min(box.u_first, u), std::min(box.v_first, v), std::max(box.u_last, u),
           std::max(box.v_last, v)};
  }
  return {std::max(0, box.u_first - kMargin_px), std::max(0, box.v_first - kMargin_px),
          std::min(camera.width_px - 1, box.u_last + kMargin_px),
          std::min(camera.height_px - 1, box.v_last + kMargin_px)};
}

DepthGrid empty_grid(const CameraIntrinsics& camera, const Box& box) {
  DepthGrid grid;
  grid.width_px = std::max(0, box.u_last - box.u_first + 1) + 2;
  grid.height_px = std::max(0, box.v_last - box.v_first + 1) + 2;
  grid.fx_px = static_cast<float>(camera.fx_px);
  grid.fy_px = static_cast<float>(camera.fy_px);
  grid.cx_px = static_cast<float>(camera.cx_px - box.u_first + 1);
  grid.cy_px = static_cast<float>(camera.cy_px - box.v_first + 1);
  const std::size_t count =
      static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px);
  grid.z_m.assign(count, 0);
  grid.normals.assign(count, Eigen::Vector3f::Zero());
  grid.is_part.assign(count, 0);
  grid.is_claimed.assign(count, 0);
  grid.packed.assign(count, 0);
  return grid;
}

/// Copies the box out of the frame; through the lens where it distorts.
void take_readings(const CameraIntrinsics& camera, const std::vector<float>& z_m, const Box& box,
                   DepthGrid& grid) {
  const bool is_distorted = std::any_of(camera.distortion.begin(), camera.distortion.end(),
                                        [](double k) { return k != 0; });
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      int from_u = u - 1 + box.u_first;
      int from_v = v - 1 + box.v_first;
      if (is_distorted) {
        const Eigen::Vector3d ray((from_u - camera.cx_px) / camera.fx_px,
                                  (from_v - camera.cy_px) / camera.fy_px, 1);
        const Eigen::Vector2d pixel = project(camera, ray);
        from_u = static_cast<int>(std::lround(pixel.x()));
        from_v = static_cast<int>(std::lround(pixel.y()));
      }
      if (from_u < 0 || from_v < 0 || from_u >= camera.width_px || from_v >= camera.height_px) {
        continue;
      }
      grid.z_m[grid.index(u, v)] =
          z_m[static_cast<std::size_t>(from_v) * static_cast<std::size_t>(camera.width_px) +
              static_cast<std::size_t>(from_u)];
    }
  }
}

template <class Visit>
void for_neighbours(const DepthGrid& grid, int u, int v, int reach, Visit visit) {
  for (int y = std::max(0, v - reach); y <= std::min(grid.height_px - 1, v + reach); ++y) {
    for (int x = std::max(0, u - reach); x <= std::min(grid.width_px - 1, u + reach); ++x) {
      visit(x, y);
    }
  }
}

void mark_parts(const Cloud& cloud, DepthGrid& grid) {
  for (const auto& p : cloud.points_m) {
    const auto u = static_cast<int>(std::lround(p.x() / p.z() * grid.fx_px + grid.cx_px));
    const auto v = static_cast<int>(std::lround(p.y() / p.z() * grid.fy_px + grid.cy_px));
    for_neighbours(grid, u, v, 1, [&](int x, int y) {
      const std::size_t i = grid.index(x, y);
      if (grid.z_m[i] > 0 && std::abs(grid.z_m[i] - p.z()) < kSameSurface_m) grid.is_part[i] = 1;
    });
  }
}

std::uint32_t units(float z_m) {
  constexpr float kMost = 65535;
  return static_cast<std::uint32_t>(std::min(kMost, std::round(z_m / PackedDepth::kUnit_m)));
}

void pack(DepthGrid& grid) {
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      float nearest_m = 0;
      for_neighbours(grid, u, v, 1, [&](int x, int y) {
        const float z_m = grid.z_m[grid.index(x, y)];
        if (z_m > 0 && (nearest_m == 0 || z_m < nearest_m)) nearest_m = z_m;
      });
      const std::size_t i = grid.index(u, v);
      grid.packed[i] = units(grid.z_m[i]) | units(nearest_m) << kHighBits;
    }
  }
}

/// Plane through the neighbours on the same surface.
Eigen::Vector3f normal_at(const DepthGrid& grid, int u, int v) {
  const float z_m = grid.z_m[grid.index(u, v)];
  Eigen::Matrix3f A = Eigen::Matrix3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  for_neighbours(grid, u, v, kNormalReach_px, [&](int x, int y) {
    const float there_m = grid.z_m[grid.index(x, y)];
    if (there_m <= 0 || std::abs(there_m - z_m) > kNormalStep_m) return;
    const Eigen::Vector3f at(static_cast<float>(x - u), static_cast<float>(y - v), 1);
    A += at * at.transpose();
    b += at * (there_m - z_m);
  });
  if (A(2, 2) < kNormalMinCells) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f fit = A.inverse() * b;
  if (!fit.allFinite()) return Eigen::Vector3f::Zero();
  // From depth per pixel to the surface's slope.
  const float gx = fit.x() * grid.fx_px / z_m;
  const float gy = fit.y() * grid.fy_px / z_m;
  const Eigen::Vector3f ray = grid.point_m(u, v) / z_m;
  return Eigen::Vector3f(gx, gy, -1 - gx * ray.x() - gy * ray.y()).normalized();
}

}  // namespace

Eigen::Vector3f DepthGrid::point_m(int u, int v) const {
  const float z = z_m[index(u, v)];
  return {(static_cast<float>(u) - cx_px) / fx_px * z, (static_cast<float>(v) - cy_px) / fy_px * z,
          z};
}

std::size_t DepthGrid::cell_of(const Eigen::Vector3f& p_m) const {
  const auto u = static_cast<int>(std::lround(p_m.x() / p_m.z() * fx_px + cx_px));
  const auto v = static_cast<int>(std::lround(p_m.y() / p_m.z() * fy_px + cy_px));
  return contains(u, v) ? index(u, v) : z_m.size();
}

void DepthGrid::claim(const std::vector<std::size_t>& cells) {
  for (const std::size_t cell : cells) {
    is_claimed[cell] = 1;
    packed[cell] = kInFront | kInFront << kHighBits;
    const auto u = static_cast<int>(cell % static_cast<std::size_t>(width_px));
    const auto v = static_cast<int>(cell / static_cast<std::size_t>(width_px));
    for_neighbours(*this, u, v, 1, [&](int x, int y) {
      std::uint32_t& neighbour = packed[index(x, y)];
      if (neighbour != 0) neighbour = (neighbour & 0xFFFFU) | kInFront << kHighBits;
    });
  }
}

DepthGrid make_depth_grid(const DepthFrame& frame, const Cloud& parts_cloud,
                          const PreprocessParameters& parameters) {
  std::vector<float> z_m(frame.depth.size());
  std::transform(frame.depth.begin(), frame.depth.end(), z_m.begin(), [&](std::uint16_t reading) {
    const double metres = reading * frame.depth_scale_m;
    const bool in_range = metres >= parameters.min_depth_m && metres <= parameters.max_depth_m;
    return in_range ? static_cast<float>(metres) : 0.0F;
  });
  remove_stray_light(parameters, frame.camera.width_px, frame.camera.height_px, frame.camera.fx_px,
                     z_m);
  const Box box = covering(frame.camera, parts_cloud);
  DepthGrid grid = empty_grid(frame.camera, box);
  take_readings(frame.camera, z_m, box, grid);
  mark_parts(parts_cloud, grid);
  pack(grid);
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      const std::size_t i = grid.index(u, v);
      if (grid.z_m[i] > 0) grid.normals[i] = normal_at(grid, u, v);
    }
  }
  return grid;
}

}  // namespace graspd::perception
