#include "graspd/formats/depth_correction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graspd/types/camera_model.hpp"

namespace graspd {

Eigen::Matrix<double, 6, 1> depth_correction_terms(const Eigen::Vector3d& ray) {
  const double x = ray.x();
  const double y = ray.y();
  return {1, x, y, x * x, x * y, y * y};
}

DepthCorrector::DepthCorrector(const DepthCorrection& correction, const CameraIntrinsics& camera)
    : correction_(correction) {
  using Terms = Eigen::Map<const Eigen::Matrix<double, 6, 1>>;
  const Terms offset_m(correction.offset_m.data());
  const Terms slope(correction.slope.data());
  pixels_.reserve(static_cast<std::size_t>(camera.width_px) *
                  static_cast<std::size_t>(camera.height_px));
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const auto terms = depth_correction_terms(ray_through(camera, u, v));
      pixels_.push_back(
          {static_cast<float>(terms.dot(offset_m)), static_cast<float>(terms.dot(slope))});
    }
  }
}

void DepthCorrector::correct(DepthFrame& frame) const {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  for (std::size_t i = 0; i < std::min(frame.depth.size(), pixels_.size()); ++i) {
    if (frame.depth[i] == 0) continue;
    const double z_m = frame.depth[i] * frame.depth_scale_m;
    const double fitted_m = std::clamp(z_m, correction_.min_depth_m, correction_.max_depth_m);
    const double corrected_m =
        z_m + pixels_[i].offset_m + (fitted_m - correction_.reference_m) * pixels_[i].slope;
    frame.depth[i] = static_cast<std::uint16_t>(
        std::clamp(std::round(corrected_m / frame.depth_scale_m), 0.0, kMost));
  }
}

}  // namespace graspd
