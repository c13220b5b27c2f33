#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd {

/// Pinhole camera with OpenCV's distortion model. Pixel (0, 0) is the centre of the top left pixel.
/// Optical frame: x right, y down, z forward, metres.
struct CameraIntrinsics {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3; all zero where images are rectified.

  bool operator==(const CameraIntrinsics&) const = default;
};

/// One depth image, row by row from the top left. 0 is "no reading"; any other value times
/// `depth_scale_m` is the z coordinate in the optical frame, in metres.
struct DepthFrame {
  CameraIntrinsics camera;
  double depth_scale_m = 0.001;
  std::vector<std::uint16_t> depth;  ///< width × height
  /// When its exposure began, on the monotonic clock of the cell that took it; recordings don't
  /// say. Stays in the cell: the server needs no clock.
  std::optional<std::chrono::nanoseconds> stamp = std::nullopt;

  /// The reading in column u and row v; the caller keeps within the image.
  std::uint16_t at(int u, int v) const {
    return depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width_px) +
                 static_cast<std::size_t>(u)];
  }
};

/// Larger images are refused by `validate`.
inline constexpr int kMaxImageSide_px = 2048;

/// The checks every frame passes before anything is computed from it: sizes, focal lengths, centre
/// within the image's neighbourhood, finite numbers, scale, buffer length, at least one reading.
/// \returns INVALID_ARGUMENT naming the field, its value and what would be right.
Result<void> validate(const CameraIntrinsics& camera);
Result<void> validate(const DepthFrame& frame);

}  // namespace graspd
