#pragma once

#include <vector>

#include "graspd/agent/ports.hpp"

namespace graspd::agent {

/// Turns depth frames into what the arm must keep clear of. Keeps the rays of the last camera,
/// which take longer to compute than all the rest.
class Surveyor {
 public:
  /// The request's bin, and the frame's readings in it and within 0.1 m of it; without a bin those
  /// in the crop box, and without that all.
  Surroundings survey(const DepthFrame& frame, const PlanRequest& request);

 private:
  CameraIntrinsics camera_;
  std::vector<Eigen::Vector3f> rays_;  ///< z = 1, by pixel
};

}  // namespace graspd::agent
