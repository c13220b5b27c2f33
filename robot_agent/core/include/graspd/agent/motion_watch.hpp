#pragma once

#include <chrono>
#include <optional>

#include "graspd/agent/joint_driver.hpp"

/// What drivers of arms check before and during a motion, whatever they talk to.
namespace graspd::agent {

/// Less than this between two reports is an arm that stands: encoders tick, and belts creep.
inline constexpr double kStill_rad = 1e-4;

/// What still counts as following a trajectory.
struct WatchLimits {
  double start_tolerance_rad = 0.05;  ///< of the first point from where the arm stands
  double goal_tolerance_rad = 0.01;
  std::chrono::milliseconds overtime{5000};  ///< an arm may take this much longer than planned
};

/// Whether an arm that stands at `standing_rad` can follow the trajectory.
/// \returns INVALID_ARGUMENT where there is no point, a point has another number of joints or is
/// not finite, times do not increase from 0, or the first point is elsewhere.
Result<void> check_trajectory(const JointTrajectory& trajectory, const Joints& standing_rad,
                              const WatchLimits& limits);

/// One motion, as a controller's reports tell it.
class MotionWatch {
 public:
  /// \param trajectory checked, and sent at the time `start`.
  MotionWatch(const JointTrajectory& trajectory, const WatchLimits& limits,
              std::chrono::nanoseconds start);

  /// A report: where the joints are, and whether they move where the controller knows.
  /// \returns whether the arm stands at the goal: every joint within the tolerance, not in motion,
  /// and either seen to move or out of planned time, since a path may end where it begins.
  bool has_arrived(const Joints& q_rad, std::optional<bool> in_motion,
                   std::chrono::nanoseconds now);
  /// \returns DEADLINE_EXCEEDED, with the joint that is farthest from its goal, once the planned
  /// time and the overtime are over.
  Result<void> in_time(std::chrono::nanoseconds now) const;

 private:
  Joints goal_rad_;
  WatchLimits limits_;
  std::chrono::nanoseconds planned_end_;
  Joints last_rad_;
  bool has_moved_ = false;
};

}  // namespace graspd::agent
