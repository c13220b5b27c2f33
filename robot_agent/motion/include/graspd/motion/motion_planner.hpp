#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graspd/agent/motions.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/motion_parameters.hpp"
#include "graspd/motion/trajectory.hpp"

namespace graspd::motion {

/// Plans motions one after the other, for an arm that follows trajectories. A free motion goes by
/// the direct way in the joints, else by one that first rises and comes from above, else by one
/// that RRTConnect finds. Of the ways to reach a pose (the arm's branches, the gripper turned by
/// 180°) the nearest is taken from which the straight motions that follow can be done. Belongs to
/// one thread; the same questions have the same answers.
class MotionPlanner {
 public:
  /// \returns INVALID_ARGUMENT with a sentence on what in the parameters doesn't fit the arm.
  static Result<MotionPlanner> create(const ArmModel& arm, const MotionParameters& parameters);
  ~MotionPlanner();
  MotionPlanner(MotionPlanner&&) noexcept;

  const ArmModel& arm() const;

  /// \param standing_rad where the arm stood when the readings were taken.
  void set_surroundings(const agent::Surroundings& surroundings, const agent::Joints& standing_rad);

  /// One trajectory a motion.
  /// \returns INVALID_ARGUMENT with the reason of the first motion that can't be done:
  /// "approach: joint_3 would be at …, after 12 mm".
  Result<std::vector<agent::JointTrajectory>> plan(std::span<const agent::Motion> motions,
                                                   const agent::Joints& from_rad);
  /// A free way of the arm with nothing in its gripper.
  Result<agent::JointTrajectory> plan_to(const agent::Joints& to_rad,
                                         const agent::Joints& from_rad);

 private:
  struct Impl;
  explicit MotionPlanner(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::motion
