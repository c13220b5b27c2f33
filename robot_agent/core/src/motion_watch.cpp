#include "graspd/agent/motion_watch.hpp"

#include <cmath>

namespace graspd::agent {
namespace {

std::chrono::nanoseconds duration_of(const JointTrajectory& trajectory) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(trajectory.back().t_s * 1e9));
}

}  // namespace

Result<void> check_trajectory(const JointTrajectory& trajectory, const Joints& standing_rad,
                              const WatchLimits& limits) {
  if (trajectory.empty()) return invalid("the trajectory has no points");
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const JointPoint& point = trajectory[i];
    if (point.q_rad.size() != standing_rad.size()) {
      return invalid("point {} of the trajectory has {} joints, the arm has {}", i,
                     point.q_rad.size(), standing_rad.size());
    }
    if (!point.q_rad.allFinite() || !std::isfinite(point.t_s)) {
      return invalid("point {} of the trajectory is not finite", i);
    }
    if (i == 0 ? point.t_s != 0 : point.t_s <= trajectory[i - 1].t_s) {
      return invalid("point {} of the trajectory is at {} s: times increase from 0", i, point.t_s);
    }
  }
  Eigen::Index joint = 0;
  const double off_rad = (trajectory.front().q_rad - standing_rad).cwiseAbs().maxCoeff(&joint);
  if (off_rad > limits.start_tolerance_rad) {
    return invalid(
        "the trajectory starts {:.3f} rad from where joint {} stands, at {:.3f} rad: plan it anew",
        off_rad, joint + 1, standing_rad[joint]);
  }
  return {};
}

MotionWatch::MotionWatch(const JointTrajectory& trajectory, const WatchLimits& limits,
                         std::chrono::nanoseconds start)
    : goal_rad_(trajectory.back().q_rad),
      limits_(limits),
      planned_end_(start + duration_of(trajectory)),
      last_rad_(trajectory.front().q_rad) {}

bool MotionWatch::has_arrived(const Joints& q_rad, std::optional<bool> in_motion,
                              std::chrono::nanoseconds now) {
  const bool moves = in_motion.value_or((q_rad - last_rad_).cwiseAbs().maxCoeff() > kStill_rad);
  last_rad_ = q_rad;
  has_moved_ |= moves;
  const bool is_there = (q_rad - goal_rad_).cwiseAbs().maxCoeff() <= limits_.goal_tolerance_rad;
  return is_there && !moves && (has_moved_ || now >= planned_end_);
}

Result<void> MotionWatch::in_time(std::chrono::nanoseconds now) const {
  if (now <= planned_end_ + limits_.overtime) return {};
  Eigen::Index joint = 0;
  const double off_rad = (goal_rad_ - last_rad_).cwiseAbs().maxCoeff(&joint);
  return fail(Code::kDeadlineExceeded,
              "the arm did not arrive within {:.1f} s of the planned time: joint {} is {:.3f} rad "
              "from its goal",
              std::chrono::duration<double>(limits_.overtime).count(), joint + 1, off_rad);
}

}  // namespace graspd::agent
