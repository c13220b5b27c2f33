#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/grs.hpp"

namespace graspd::perception {

/// How near a part is to the camera, in a rectangle of an image around it. Drawn into again and
/// again, it takes no memory for each part.
struct Silhouette {
  static constexpr float kNone_m = std::numeric_limits<float>::max();
  int u_first = 0, v_first = 0, width = 0, height = 0;
  std::vector<float> nearest_m;  ///< kNone_m beside the part
  std::vector<float> rows_m;     ///< of `smear`

  float* row(int y) { return &nearest_m[static_cast<std::size_t>(y) * width]; }
  /// Gives each cell the nearest of those up to `by_px` away.
  void smear(int by_px);
};

/// Draws every other point of the part's template and smears them, so that the gaps between them
/// close where `smear_px` is 2 or more. The rectangle keeps one cell off the image's edges; it is
/// empty where the part is beside the image or behind the camera.
void draw_silhouette(const PlacedPart& part, const Eigen::Isometry3d& T_camera_floor,
                     const PixelGrid& image, int smear_px, Silhouette& silhouette);

}  // namespace graspd::perception
