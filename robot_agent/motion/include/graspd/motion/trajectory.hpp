#pragma once

#include <span>
#include <vector>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/motion/arm_model.hpp"

namespace graspd::motion {

/// Points on a way through joint space, near enough to each other that a straight line between two
/// neighbours will do.
struct JointPath {
  std::vector<agent::Joints> q_rad;
  /// How far the grasp frame moves from each point to the next where its speed is limited; 0 where
  /// it is not. One less than points.
  std::vector<double> tip_m;

  /// Another path that begins where this one ends.
  void append(const JointPath& other);
};

/// Straight in the joints, in equal steps of at most `step_rad` of the joint that turns most.
JointPath joint_line(const agent::Joints& from_rad, const agent::Joints& to_rad, double step_rad);

/// As fast as the joints' limits of velocity and acceleration and the tip's of speed allow, all
/// joints together, from rest to rest, a point every `period_s`. Corners are rounded by at most an
/// eighth of the way between neighbours. Two points where the path does not move.
agent::JointTrajectory time_parameterise(const JointPath& path, std::span<const JointLimits> limits,
                                         double max_tip_speed_m_s, double period_s);

}  // namespace graspd::motion
