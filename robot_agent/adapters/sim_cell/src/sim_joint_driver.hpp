#pragma once

#include "graspd/agent/joint_driver.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::agent {

/// An arm's controller that follows trajectories to the letter, in simulated time.
class SimJointDriver final : public JointDriver {
 public:
  SimJointDriver(sim_cell::PhysicsCell& cell, motion::MountedArm arm)
      : cell_(cell), arm_(std::move(arm)), q_rad_(arm_.out_of_view_rad) {}

  Result<Joints> joints() override { return q_rad_; }
  Result<void> follow(const JointTrajectory& trajectory) override;
  Result<void> stop() override { return {}; }

 private:
  sim_cell::PhysicsCell& cell_;
  motion::MountedArm arm_;
  Joints q_rad_;
};

/// Gripper and links of an arm in a posture.
sim_cell::RobotPose robot_pose(const motion::MountedArm& arm, const Joints& q_rad);

}  // namespace graspd::agent
