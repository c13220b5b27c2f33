#include <algorithm>
#include <array>
#include <cmath>

#include "graspd/perception/depth_grid.hpp"

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
  float nearest_m = z_m, farthest_m = z_m;            // within the reach
  float nearest_next_m = z_m, farthest_next_m = z_m;  // within one pixel
  float sum_m = 0, total = 0;
  std::size_t i = 0;
  for (int y = -kReach_px; y <= kReach_px; ++y) {
    for (int x = -kReach_px; x <= kReach_px; ++x, ++i) {
      const float there_m = grid.z_m[grid.index(u + x, v + y)];
      if (there_m <= 0) continue;
      sum_m += weights[i] * there_m;
      total += weights[i];
      nearest_m = std::min(nearest_m, there_m);
      farthest_m = std::max(farthest_m, there_m);
      if (std::abs(x) > 1 || std::abs(y) > 1) continue;
      nearest_next_m = std::min(nearest_next_m, there_m);
      farthest_next_m = std::max(farthest_next_m, there_m);
    }
  }
  if (farthest_m - nearest_m < kEdge_m) return z_m;
  return std::clamp(z_m + gain * (z_m - sum_m / total), nearest_next_m, farthest_next_m);
}

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
  for (int v = kReach_px; v < grid.height_px - kReach_px; ++v) {
    for (int u = kReach_px; u < grid.width_px - kReach_px; ++u) {
      const std::size_t i = grid.index(u, v);
      if (grid.z_m[i] > 0) mended_m[i] = sharpened(grid, u, v, gain, weights);
    }
  }
  grid.z_m = std::move(mended_m);
}

}  // namespace graspd::perception
