#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "graspd/types/frame.hpp"

namespace graspd {

/// What one camera's depth is off by, fitted to a flat board (`robot_agent calibrate`). A reading z
/// on the ray (x, y, 1) is moved by
///   φ·offset_m + (z − reference_m) φ·slope,   φ = (1, x, y, x², xy, y²).
/// Beyond the depths it was fitted over it stays what it is at the nearer end.
struct DepthCorrection {
  std::array<double, 6> offset_m{};
  std::array<double, 6> slope{};
  double reference_m = 0;
  double min_depth_m = 0;
  double max_depth_m = 0;
};

/// (1, x, y, x², xy, y²) of a ray at z = 1.
Eigen::Matrix<double, 6, 1> depth_correction_terms(const Eigen::Vector3d& ray);

/// A correction, made ready for the frames of one camera.
class DepthCorrector {
 public:
  /// Computes the terms of every pixel, along its undistorted ray.
  DepthCorrector(const DepthCorrection& correction, const CameraIntrinsics& camera);
  /// \param frame of this camera's size. A pixel without a reading stays without one.
  void correct(DepthFrame& frame) const;

 private:
  struct Pixel {
    float offset_m;
    float slope;
  };
  DepthCorrection correction_;
  std::vector<Pixel> pixels_;
};

}  // namespace graspd
