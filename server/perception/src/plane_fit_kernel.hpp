#pragma once

#include <cstddef>

/// Plain floats only: compiled once for each instruction set.
namespace graspd::perception {

inline constexpr int kFitReach_px = 3;
inline constexpr std::size_t kFitPadding = 64;  ///< values beyond a row's end, read or written

/// One row of an image. Pointers to the row's first cell.
struct FitRow {
  const float* z_m;  ///< with `kFitReach_px` cells on every side that can be read
  std::size_t stride, width;
  float fx_px, fy_px, cx_px;
  float ray_y;  ///< of the row
  float *normals, *curvatures;
};

void fit_row(const FitRow& row);

}  // namespace graspd::perception
