#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "graspd/perception/depth_grid.hpp"
#include "parallel.hpp"

namespace graspd::perception {
namespace {

/// Second differences beyond this are edges, not noise.
constexpr float kNoiseMost_m = 0.008F;
/// With less noise than this there is none to tell from.
constexpr float kNoiseLeast_m = 0.0005F;
/// Ratio of second differences one and two pixels apart: of white noise, and of noise smoothed so
/// far that all of `kMostGain` is needed (a Gaussian of 0.9 pixels).
constexpr float kWhiteRatio = 0.95F;
constexpr float kSmoothRatio = 0.5F;
constexpr float kMostGain = 4;

constexpr int kReach_px = 2;
constexpr float kSigma_px = 1.2F;
constexpr float kEdge_m = 0.01F;  ///< within the reach: less is no edge

float second_difference(const float* z_m, std::ptrdiff_t step) {
  const bool is_there = z_m[-step] > 0 && z_m[0] > 0 && z_m[step] > 0;
  return is_there ? std::abs(z_m[-step] - 2 * z_m[0] + z_m[step]) : 2 * kNoiseMost_m;
}

using Weights =
    std::array<float, static_cast<std::size_t>((2 * kReach_px + 1) * (2 * kReach_px + 1))>;

Weights gaussian() {
  Weights weights{};
  std::size_t i = 0;
  for (int y = -kReach_px; y <= kReach_px; ++y) {
    for (int x = -kReach_px; x <= kReach_px; ++x) {
      weights[i++] = std::exp(-static_cast<float>(x * x + y * y) / (2 * kSigma_px * kSigma_px));
    }
  }
  return weights;
}

/// What unsharp masking makes of a reading: away from the mean around it, not beyond its
/// neighbours.
float sharpened(const DepthGrid& grid, int u, int v, float gain, const Weights& weights) {
  const float z_m = grid.z_m[grid.index(u, v)];
  float nearest_m = z_m, farthest_m = z_m;  // within one pixel
  float sum_m = 0, total = 0;
  std::size_t i = 0;
  for (int y = -kReach_px; y <= kReach_px; ++y) {
    for (int x = -kReach_px; x <= kReach_px; ++x, ++i) {
      const float there_m = grid.z_m[grid.index(u + x, v + y)];
      if (there_m <= 0) continue;
      sum_m += weights[i] * there_m;
      total += weights[i];
      if (std::abs(x) > 1 || std::abs(y) > 1) continue;
      nearest_m = std::min(nearest_m, there_m);
      farthest_m = std::max(farthest_m, there_m);
    }
  }
  return std::clamp(z_m + gain * (z_m - sum_m / total), nearest_m, farthest_m);
}

/// How far apart the readings around a cell are, for the cells of one row.
class RangesOfRow {
 public:
  explicit RangesOfRow(std::size_t width)
      : nearest_m_(width), farthest_m_(width), ranges_m_(width, 0) {}

  /// None of the row's outermost `kReach_px` cells.
  const std::vector<float>& of(const DepthGrid& grid, int v) {
    constexpr float kNone_m = std::numeric_limits<float>::max();
    const std::size_t width = ranges_m_.size();
    // Of each column, then of as many columns.
    std::ranges::fill(nearest_m_, kNone_m);
    std::ranges::fill(farthest_m_, 0.0F);
    for (int y = -kReach_px; y <= kReach_px; ++y) {
      const float* z_m = &grid.z_m[grid.index(0, v + y)];
      for (std::size_t u = 0; u < width; ++u) {
        nearest_m_[u] = std::min(nearest_m_[u], z_m[u] > 0 ? z_m[u] : kNone_m);
        farthest_m_[u] = std::max(farthest_m_[u], z_m[u]);
      }
    }
    for (std::size_t u = kReach_px; u + kReach_px < width; ++u) {
      float nearest_m = kNone_m, farthest_m = 0;
      for (std::size_t x = u - kReach_px; x <= u + kReach_px; ++x) {
        nearest_m = std::min(nearest_m, nearest_m_[x]);
        farthest_m = std::max(farthest_m, farthest_m_[x]);
      }
      ranges_m_[u] = farthest_m - nearest_m;
    }
    return ranges_m_;
  }

 private:
  std::vector<float> nearest_m_, farthest_m_, ranges_m_;
};

}  // namespace

float sharpening_gain(const DepthGrid& grid) {
  double one_apart_m = 0, two_apart_m = 0;
  std::size_t count = 0;
  for (int v = 0; v < grid.height_px; ++v) {
    for (int u = 2; u < grid.width_px - 2; ++u) {
      const float* z_m = &grid.z_m[grid.index(u, v)];
      const float one_m = second_difference(z_m, 1);
      const float two_m = second_difference(z_m, 2);
      if (one_m > kNoiseMost_m || two_m > kNoiseMost_m) continue;
      one_apart_m += static_cast<double>(one_m);
      two_apart_m += static_cast<double>(two_m);
      ++count;
    }
  }
  if (two_apart_m <= static_cast<double>(kNoiseLeast_m) * static_cast<double>(count)) return 0;
  const auto ratio = static_cast<float>(one_apart_m / two_apart_m);
  return kMostGain * std::clamp((kWhiteRatio - ratio) / (kWhiteRatio - kSmoothRatio), 0.0F, 1.0F);
}

void sharpen_edges(DepthGrid& grid) {
  const float gain = sharpening_gain(grid);
  if (!(gain > 0)) return;
  static const Weights weights = gaussian();
  std::vector<float> mended_m = grid.z_m;
  tbb::enumerable_thread_specific<RangesOfRow> memory(static_cast<std::size_t>(grid.width_px));
  const int rows_n = std::max(0, grid.height_px - 2 * kReach_px);
  parallel_for(static_cast<std::size_t>(rows_n), [&](std::size_t row) {
    const int v = static_cast<int>(row) + kReach_px;
    const std::vector<float>& ranges_m = memory.local().of(grid, v);
    for (int u = kReach_px; u < grid.width_px - kReach_px; ++u) {
      if (ranges_m[static_cast<std::size_t>(u)] < kEdge_m) continue;
      const std::size_t i = grid.index(u, v);
      if (grid.z_m[i] > 0) mended_m[i] = sharpened(grid, u, v, gain, weights);
    }
  });
  grid.z_m = std::move(mended_m);
}

}  // namespace graspd::perception
