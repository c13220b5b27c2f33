#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/part.hpp"

namespace graspd::eval {

/// Maximum Symmetry-aware Surface Distance, metres (BOP): the least over the part's symmetries of
/// the largest distance between a surface point in the estimated and in the true pose.
double mssd_m(const parts::Part& part, const Eigen::Isometry3d& T_camera_part_estimated,
              const Eigen::Isometry3d& T_camera_part_true);

/// The two parts of a pose's error that people can picture.
struct PoseError {
  double translation_m = 0;  ///< of the barycentre
  double rotation_rad = 0;   ///< in [0, π]
};

/// Each the least over the part's symmetries; turns about a continuous symmetry's axis exactly, and
/// every turn where there are several axes, as a ball has.
PoseError pose_error(const parts::Part& part, const Eigen::Isometry3d& T_camera_part_estimated,
                     const Eigen::Isometry3d& T_camera_part_true);

/// Every T_part_part′ that moves the part onto itself, the identity first; continuous symmetries
/// in steps that move no point by more than about a hundredth of the diameter.
std::vector<Eigen::Isometry3d> all_symmetries(const parts::Part& part);

}  // namespace graspd::eval
