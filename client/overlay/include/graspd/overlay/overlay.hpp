#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "graspd/types/answer.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

/// The one picture of a plan: what was recognised and where it would be gripped, over the depth
/// image. Agent and command line draw with this, so that pictures can be compared.
namespace graspd::overlay {

/// Which part of the depth image the picture shows, and how much larger.
struct View {
  int left_px = 0;
  int top_px = 0;
  int width_px = 0;
  int height_px = 0;
  int scale = 2;

  /// From the depth image's pixels to the picture's.
  double x(double u_px) const { return (u_px - left_px + 0.5) * scale - 0.5; }
  double y(double v_px) const { return (v_px - top_px + 0.5) * scale - 0.5; }
};

/// What has readings in the bin or crop box (or, without either, anywhere), with a margin: the same
/// for each frame of the same scene, within a few pixels. Scaled up to about a thousand pixels.
View view_of(const DepthFrame& frame, const PlanRequest& request);

/// 8 bits a channel, sRGB.
struct RgbImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;  ///< row by row

  const std::array<std::uint8_t, 3>& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)];
  }
};

/// Colours that stay apart for every kind of colour vision (Okabe and Ito 2008). The best grasp has
/// one to itself.
inline constexpr std::array<std::uint8_t, 3> kBestGraspColor{255, 110, 0};
inline constexpr std::array<std::uint8_t, 3> kGraspColor{255, 255, 255};
inline constexpr std::array<std::uint8_t, 3> kNoReadingColor{18, 18, 28};

/// Depth in grey, near is bright, stretched over what lies in the bin or crop box; registered
/// outlines (where the request asked for them); each object's best grasp as its two open jaws with
/// the closing line and its rank; below, the outcome and what the signs mean.
/// \param frame, request, answer one valid frame, what was asked of it, what was answered
RgbImage draw(const DepthFrame& frame, const PlanRequest& request, const PlanAnswer& answer);

/// A file's bytes, to be written or sent elsewhere.
std::vector<std::uint8_t> png_of(const RgbImage& image);
/// \returns INVALID_ARGUMENT where the file can't be written.
Result<void> write_png(const std::filesystem::path& path, const RgbImage& image);

}  // namespace graspd::overlay
