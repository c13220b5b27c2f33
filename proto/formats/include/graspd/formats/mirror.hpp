#pragma once

#include <algorithm>
#include <vector>

#include "graspd/types/frame.hpp"

/// A Kinect v2 delivers its images left to right, as a mirror shows them. A cloud of a mirrored
/// frame never fits a part that has a handedness.
namespace graspd {

/// Swaps left and right.
template <class Pixel>
void mirror_rows(std::vector<Pixel>& image, int width_px) {
  for (auto row = image.begin(); row != image.end(); row += width_px) {
    std::reverse(row, row + width_px);
  }
}

/// The intrinsics of the mirrored image.
inline CameraIntrinsics mirrored(CameraIntrinsics camera) {
  camera.cx_px = camera.width_px - 1 - camera.cx_px;
  camera.distortion[3] = -camera.distortion[3];  // p2 is tangential along x
  return camera;
}

}  // namespace graspd
