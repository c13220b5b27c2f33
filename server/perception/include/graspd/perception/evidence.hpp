#pragma once

#include <Eigen/Geometry>

#include "graspd/parts/part.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::perception {

/// What the depth image says of a pose: each template point that the camera should see, were the
/// part alone, is compared with the readings at its pixel.
struct Evidence {
  double visible_fraction = 0;  ///< of those points: a reading within tolerance
  double refuted_fraction = 0;  ///< of those points: every reading near its pixel is behind it
  double inlier_fraction = 0;   ///< within tolerance / (within tolerance + refuted)
  double rms_m = 0;             ///< over the points within tolerance, along the optical axis
  /// Visible less refuted fraction, not below 0. 1: all of the part's front is seen where it
  /// should be.
  double score = 0;
};

/// The sensor blurs a silhouette over about a pixel: a point is refuted only where no reading
/// within one pixel is near enough. A reading in front of a point hides it; no reading says
/// nothing.
Evidence evaluate_pose(const DepthFrame& frame, const parts::Part& part,
                       const Eigen::Isometry3d& T_camera_part, double tolerance_m);

}  // namespace graspd::perception
