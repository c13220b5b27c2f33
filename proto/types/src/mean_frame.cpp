#include "graspd/types/mean_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace graspd {
namespace {

constexpr double kSameSurface_m = 0.01;
constexpr int kFiner = 10;
constexpr std::uint16_t kDeepest = std::numeric_limits<std::uint16_t>::max();

Result<void> check(std::span<const DepthFrame> frames) {
  if (frames.empty() || frames.size() > kMaxMeanFrames) {
    return invalid("a mean of {} frames: take 1 to {}", frames.size(), kMaxMeanFrames);
  }
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const bool is_alike = frames[i].camera == frames[0].camera &&
                          frames[i].depth_scale_m == frames[0].depth_scale_m &&
                          frames[i].depth.size() == frames[0].depth.size();
    if (!is_alike) {
      return invalid("a mean of frames: frame {} has another camera, unit or size than frame 0", i);
    }
  }
  return {};
}

/// How many of the mean's units are one of the frames'.
int units(std::span<const DepthFrame> frames) {
  std::uint16_t deepest = 1;
  for (const DepthFrame& frame : frames) {
    if (!frame.depth.empty()) deepest = std::max(deepest, *std::ranges::max_element(frame.depth));
  }
  return std::clamp(kDeepest / deepest, 1, kFiner);
}

/// \param readings of one pixel; is put in order.
double mean_near_median(std::span<std::uint16_t> readings, double same_surface) {
  std::ranges::sort(readings);
  const double median = readings[(readings.size() - 1) / 2];
  double sum = 0;
  int count = 0;
  for (const std::uint16_t reading : readings) {
    if (std::abs(reading - median) > same_surface) continue;
    sum += reading;
    ++count;
  }
  return sum / count;
}

}  // namespace

Result<DepthFrame> mean_frame(std::span<const DepthFrame> frames) {
  if (auto ok = check(frames); !ok) return tl::unexpected(ok.error());
  DepthFrame mean = frames.front();
  if (frames.size() == 1) return mean;
  const int finer = units(frames);
  const double same_surface = kSameSurface_m / mean.depth_scale_m;
  mean.depth_scale_m /= finer;
  for (std::size_t i = 0; i < mean.depth.size(); ++i) {
    std::array<std::uint16_t, kMaxMeanFrames> readings;
    std::size_t readings_n = 0;
    for (const DepthFrame& frame : frames) {
      if (frame.depth[i] != 0) readings[readings_n++] = frame.depth[i];
    }
    mean.depth[i] = 0;
    if (2 * readings_n <= frames.size()) continue;
    const double value = mean_near_median({readings.data(), readings_n}, same_surface);
    mean.depth[i] = static_cast<std::uint16_t>(std::lround(finer * value));
  }
  return mean;
}

}  // namespace graspd
