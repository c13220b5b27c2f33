#include "graspd/perception/depth_grid.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "graspd/perception/plane_fit.hpp"
#include "graspd/types/camera_model.hpp"
#include "parallel.hpp"

namespace graspd::perception {
namespace {

constexpr int kMargin_px = 12;
constexpr float kHalfCell_px = 0.5F;
/// A cell belongs to the parts where a point of theirs lies within a pixel, about as deep.
constexpr float kSameSurface_m = 0.03F;
/// By how much a silhouette is smeared, and poses are off: a pixel of a Kinect v2 at 0.75 m, more
/// pixels of a finer image. With one pixel everywhere, an elbow that lay free under a RealSense at
/// 0.45 m was refuted along its outline.
constexpr float kBlur_m = 0.002F;
constexpr int kMostBlur_px = 4;

constexpr std::uint32_t kInFront = 1;  // nearer than any reading
constexpr int kHighBits = 16;

PixelGrid image_of(const CameraIntrinsics& camera) {
  return {camera.width_px,
          camera.height_px,
          static_cast<float>(camera.fx_px),
          static_cast<float>(camera.fy_px),
          static_cast<float>(camera.cx_px),
          static_cast<float>(camera.cy_px)};
}

/// A box of the image, with cells around it that hold nothing.
DepthGrid empty_grid(const PixelGrid& image, const CellBox& box) {
  DepthGrid grid;
  grid.width_px = std::max(0, box.u_last - box.u_first + 1) + 2;
  grid.height_px = std::max(0, box.v_last - box.v_first + 1) + 2;
  grid.fx_px = image.fx_px;
  grid.fy_px = image.fy_px;
  grid.cx_px = image.cx_px - static_cast<float>(box.u_first - 1);
  grid.cy_px = image.cy_px - static_cast<float>(box.v_first - 1);
  grid.z_m.assign(
      static_cast<std::size_t>(grid.width_px) * static_cast<std::size_t>(grid.height_px), 0);
  return grid;
}

/// From each cell to the eight around it and itself.
std::array<std::ptrdiff_t, 9> offsets_around(const DepthGrid& grid) {
  const std::ptrdiff_t row = grid.width_px;
  return {-row - 1, -row, -row + 1, -1, 0, 1, row - 1, row, row + 1};
}

int blur_px(const Cloud& cloud, float fx_px) {
  if (cloud.empty()) return 1;
  float z_sum_m = 0;
  for (const auto& p : cloud.points_m) z_sum_m += p.z();
  const float mean_z_m = z_sum_m / static_cast<float>(cloud.points_m.size());
  return std::clamp(static_cast<int>(std::lround(kBlur_m * fx_px / mean_z_m)), 1, kMostBlur_px);
}

std::uint32_t units(float z_m) {
  constexpr float kMost = 65535;
  return static_cast<std::uint32_t>(std::min(kMost, z_m / PackedDepth::kUnit_m + 0.5F));
}

}  // namespace

Eigen::Vector3f DepthGrid::point_m(int u, int v) const {
  const float z = z_m[index(u, v)];
  return {(static_cast<float>(u) - cx_px) / fx_px * z, (static_cast<float>(v) - cy_px) / fy_px * z,
          z};
}

std::size_t DepthGrid::cell_of(const Eigen::Vector3f& p_m) const {
  // Rounded without a call: what is below 0 must not become 0.
  const float u = p_m.x() / p_m.z() * fx_px + cx_px + kHalfCell_px;
  const float v = p_m.y() / p_m.z() * fy_px + cy_px + kHalfCell_px;
  const bool is_inside = u >= 1 && v >= 1 && u < static_cast<float>(width_px - 1) &&
                         v < static_cast<float>(height_px - 1);
  return is_inside ? index(static_cast<int>(u), static_cast<int>(v)) : z_m.size();
}

void DepthGrid::take_for_floor(std::size_t cell) {
  is_part[cell] = 0;
  packed[cell] &= ~0xFFFFU;
}

void DepthGrid::claim(const std::vector<std::uint32_t>& cells) {
  for (const std::uint32_t cell : cells) {
    is_claimed[cell] = 1;
    packed[cell] = kInFront | kInFront << kHighBits;
    const int cell_u = static_cast<int>(cell) % width_px;
    const int cell_v = static_cast<int>(cell) / width_px;
    const int last_u = std::min(cell_u + blur_px, width_px - 2);
    const int last_v = std::min(cell_v + blur_px, height_px - 2);
    for (int v = std::max(1, cell_v - blur_px); v <= last_v; ++v) {
      for (int u = std::max(1, cell_u - blur_px); u <= last_u; ++u) {
        std::uint32_t& neighbour = packed[index(u, v)];
        if (neighbour != 0) neighbour = (neighbour & 0xFFFFU) | kInFront << kHighBits;
      }
    }
  }
}

CellBox box_around(const Cloud& cloud, const PixelGrid& image) {
  if (cloud.empty()) return {};
  Eigen::AlignedBox2f rays;
  for (const auto& p : cloud.points_m) rays.extend(p.head<2>() / p.z());
  const auto u = [&](float ray) {
    return static_cast<int>(std::lround(ray * image.fx_px + image.cx_px));
  };
  const auto v = [&](float ray) {
    return static_cast<int>(std::lround(ray * image.fy_px + image.cy_px));
  };
  return {std::max(0, u(rays.min().x()) - kMargin_px), std::max(0, v(rays.min().y()) - kMargin_px),
          std::min(image.width_px - 1, u(rays.max().x()) + kMargin_px),
          std::min(image.height_px - 1, v(rays.max().y()) + kMargin_px)};
}

std::vector<float> readings_m(const DepthFrame& frame, const PreprocessParameters& parameters) {
  const auto scale_m = static_cast<float>(frame.depth_scale_m);
  const auto least_m = static_cast<float>(parameters.min_depth_m);
  const auto most_m = static_cast<float>(parameters.max_depth_m);
  std::vector<float> z_m(frame.depth.size());
  for (std::size_t i = 0; i < z_m.size(); ++i) {
    const float reading_m = static_cast<float>(frame.depth[i]) * scale_m;
    z_m[i] = (reading_m >= least_m) & (reading_m <= most_m) ? reading_m : 0;
  }
  return z_m;
}

DepthGrid cut_out_readings(const CameraIntrinsics& camera, const std::vector<float>& z_m,
                           const CellBox& box) {
  DepthGrid grid = empty_grid(image_of(camera), box);
  const bool is_distorted = camera.distortion != std::array<double, 5>{};
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      int from_u = u - 1 + box.u_first;
      int from_v = v - 1 + box.v_first;
      if (is_distorted) {
        const Eigen::Vector2d pixel = project(camera, {(from_u - camera.cx_px) / camera.fx_px,
                                                       (from_v - camera.cy_px) / camera.fy_px, 1});
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
  return grid;
}

DepthGrid cut_out_readings(const DepthGrid& image, const CellBox& box) {
  DepthGrid grid = empty_grid(image.pixels(), box);
  for (int v = box.v_first; v <= box.v_last; ++v) {
    std::copy_n(&image.z_m[image.index(box.u_first, v)], grid.width_px - 2,
                &grid.z_m[grid.index(1, v - box.v_first + 1)]);
  }
  return grid;
}

void pack(DepthGrid& grid) {
  constexpr float kNone_m = std::numeric_limits<float>::max();
  const auto width = static_cast<std::size_t>(grid.width_px);
  const auto blur = static_cast<std::size_t>(grid.blur_px);
  grid.packed.assign(grid.size(), 0);
  tbb::enumerable_thread_specific<std::vector<float>> memory(width + 2 * blur, kNone_m);
  parallel_for(static_cast<std::size_t>(grid.height_px - 2), [&](std::size_t row) {
    const int v = static_cast<int>(row) + 1;
    float* const nearest_m = memory.local().data() + blur;  // of each column's cells
    const float* here = &grid.z_m[grid.index(0, v)];
    const auto or_none = [](float z_m) { return z_m > 0 ? z_m : kNone_m; };
    for (std::size_t u = 0; u < width; ++u) nearest_m[u] = or_none(here[u]);
    for (int d = 1; d <= grid.blur_px; ++d) {
      const float* above = &grid.z_m[grid.index(0, std::max(0, v - d))];
      const float* below = &grid.z_m[grid.index(0, std::min(grid.height_px - 1, v + d))];
      for (std::size_t u = 0; u < width; ++u) {
        nearest_m[u] = std::min(nearest_m[u], std::min(or_none(above[u]), or_none(below[u])));
      }
    }
    std::uint32_t* packed = &grid.packed[grid.index(0, v)];
    const std::uint8_t* is_part = &grid.is_part[grid.index(0, v)];
    for (std::size_t u = 1; u + 1 < width; ++u) {
      if (here[u] <= 0) continue;
      const float* const from_m = nearest_m + u - blur;
      const float least_m = *std::min_element(from_m, from_m + 2 * blur + 1);
      packed[u] = (is_part[u] != 0 ? units(here[u]) : 0) | units(least_m) << kHighBits;
    }
  });
}

void mark_parts(const Cloud& parts_cloud, DepthGrid& grid) {
  grid.is_part.assign(grid.size(), 0);
  grid.is_claimed.assign(grid.size(), 0);
  grid.blur_px = blur_px(parts_cloud, grid.fx_px);
  const auto around = offsets_around(grid);
  for (const auto& p : parts_cloud.points_m) {
    const std::size_t cell = grid.cell_of(p);
    if (cell == grid.size()) continue;
    for (const std::ptrdiff_t offset : around) {
      const std::size_t i = cell + static_cast<std::size_t>(offset);
      const bool same = grid.z_m[i] > 0 && std::abs(grid.z_m[i] - p.z()) < kSameSurface_m;
      grid.is_part[i] |= static_cast<std::uint8_t>(same);
    }
  }
  pack(grid);
}

void fit_normals(DepthGrid& grid) {
  fit_planes(grid.z_m, grid.pixels(), grid.normals, grid.curvatures);
}

DepthGrid make_depth_grid(const DepthFrame& frame, const Cloud& parts_cloud,
                          const PreprocessParameters& parameters) {
  DepthGrid grid = cut_out_readings(frame.camera, readings_m(frame, parameters),
                                    box_around(parts_cloud, image_of(frame.camera)));
  sharpen_edges(grid);
  mark_parts(parts_cloud, grid);
  fit_normals(grid);
  return grid;
}

}  // namespace graspd::perception
