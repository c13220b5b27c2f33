#pragma once

#include "graspd/motion/inverse_kinematics.hpp"
#include "graspd/motion/trajectory.hpp"

namespace graspd::motion {

/// What moves on a straight line: the grasp frame, mounted on the flange.
struct StraightLine {
  Eigen::Isometry3d T_base_start = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_base_end = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_grasp_flange = Eigen::Isometry3d::Identity();
};

/// In equal steps of at most `step_m`, each solution the nearest to the one before. The frame turns
/// evenly on its way.
/// \param start_rad brings the frame to the line's start.
/// \returns INVALID_ARGUMENT with a sentence that says why and after how many millimetres, where a
/// joint leaves its limits or would have to jump.
Result<JointPath> straight_path(InverseKinematics& ik, const StraightLine& line,
                                const agent::Joints& start_rad, std::span<const JointLimits> limits,
                                double step_m);

}  // namespace graspd::motion
