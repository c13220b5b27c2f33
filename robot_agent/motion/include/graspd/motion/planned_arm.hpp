#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/motion_planner.hpp"

namespace graspd::motion {

/// An arm as it stands in a cell.
struct MountedArm {
  ArmModel model;
  MotionParameters parameters;
  agent::Joints out_of_view_rad;  ///< where the camera sees nothing of the arm that matters
};

/// An arm of which only the joints can be ordered: every motion is planned here, and followed by
/// its driver. What `why_not` has planned is what `move` then does, as long as the motions come in
/// that order and the arm stands where they begin; else `move` plans anew. Belongs to one thread.
class PlannedArm final : public agent::Arm {
 public:
  /// \param driver must outlive the arm.
  /// \returns INVALID_ARGUMENT with what doesn't fit the arm.
  static Result<std::unique_ptr<PlannedArm>> create(agent::JointDriver& driver,
                                                    const MountedArm& arm);

  void set_surroundings(const agent::Surroundings& surroundings) override;
  std::optional<std::string> why_not(std::span<const agent::Motion> motions) override;
  Result<void> move(const agent::Motion& motion) override;
  Result<void> move_out_of_view() override;
  Result<void> stop() override;

 private:
  struct Planned {
    agent::Motion motion;
    agent::JointTrajectory trajectory;
  };

  PlannedArm(agent::JointDriver& driver, MotionPlanner planner, agent::Joints out_of_view_rad);

  /// Where the arm stands. The planner then knows its surroundings.
  Result<agent::Joints> look();
  Result<void> plan(std::span<const agent::Motion> motions, const agent::Joints& from_rad);
  bool is_next(const agent::Motion& motion, const agent::Joints& at_rad) const;
  Result<void> follow(const agent::JointTrajectory& trajectory);

  agent::JointDriver& driver_;
  MotionPlanner planner_;
  agent::Joints out_of_view_rad_;
  std::optional<agent::Surroundings> new_surroundings_;  ///< not yet told to the planner
  std::deque<Planned> planned_;
};

}  // namespace graspd::motion
