#pragma once

#include <optional>

#include "graspd/motion/collision_world.hpp"
#include "graspd/motion/inverse_kinematics.hpp"
#include "graspd/motion/trajectory.hpp"

namespace graspd::motion {

/// What paths are made with.
struct PathTools {
  const ArmModel& arm;
  const MotionParameters& parameters;
  InverseKinematics& ik;
  CollisionWorld& world;

  Eigen::Isometry3d T_base_grasp(const agent::Joints& q_rad) const {
    return arm.T_base_flange(q_rad) * parameters.T_flange_grasp;
  }
  /// Straight to where the grasp frame has this pose, touching nothing.
  Result<JointPath> straight(const agent::Joints& from_rad, const Eigen::Isometry3d& T_base_grasp,
                             const Posture& posture) const;
};

/// The direct way, or one that first rises straight up from the start, or comes back to the goal
/// along its approach, or both.
/// \returns INVALID_ARGUMENT with what is in the direct way.
Result<JointPath> free_path(const PathTools& tools, const agent::Joints& from_rad,
                            const agent::Joints& to_rad, const Posture& posture);

/// By search, from the lowest places above start and goal where nothing is near.
/// \returns INVALID_ARGUMENT where there is no such place, or no way was found.
Result<JointPath> searched_path(const PathTools& tools, const agent::Joints& from_rad,
                                const agent::Joints& to_rad, const Posture& posture);

}  // namespace graspd::motion
