#pragma once

#include <cstddef>
#include <cstdint>

#include "graspd/perception/pose_kernel.hpp"

/// Sorts points into columns over the floor, on plain arrays. Internal to perception.
namespace graspd::perception {

/// Columns over the floor, the first of them so many columns away from the origin.
struct ColumnGrid {
  float columns_per_m;
  float x_first, y_first;
  std::int32_t width, height;
};

/// Where points are, with room for the whole vectors that the kernel writes.
struct PointColumns {
  static constexpr std::size_t kMost = 256;
  std::int32_t column[kMost + 16];  ///< x fastest; the outermost ones for what is beyond
  float z_m[kMost + 16];
};

/// \param points at most PointColumns::kMost.
void find_columns(const PointSpan& points, const KernelPose& T_floor_part, const ColumnGrid& grid,
                  PointColumns& placed);

}  // namespace graspd::perception
