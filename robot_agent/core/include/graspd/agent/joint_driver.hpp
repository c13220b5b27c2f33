#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::agent {

/// Angles of an arm's joints in radians, from the base outwards.
using Joints = Eigen::VectorXd;

/// Where the joints are at one time of a motion.
struct JointPoint {
  double t_s = 0;  ///< since the start of the motion
  Joints q_rad;
};

/// A motion, linear in the joints between its points, whose times increase from 0. The first point
/// is where the arm stands.
using JointTrajectory = std::vector<JointPoint>;

/// An arm as its controller sees it: it knows joints, not poses. Belongs to one thread.
class JointDriver {
 public:
  virtual ~JointDriver() = default;
  /// Where the joints are now.
  virtual Result<Joints> joints() = 0;
  /// Returns when the arm stands at the last point, or has stopped on an error.
  virtual Result<void> follow(const JointTrajectory& trajectory) = 0;
  /// Stand still, now, and hold. \returns why it is not known to stand: it may be moving.
  virtual Result<void> stop() = 0;
};

}  // namespace graspd::agent
