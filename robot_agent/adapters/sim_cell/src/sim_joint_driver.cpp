#include "sim_joint_driver.hpp"

#include <algorithm>

#include "graspd/agent/motion_watch.hpp"

namespace graspd::agent {
namespace {

Joints joints_at(const JointTrajectory& trajectory, double t_s) {
  auto next = std::ranges::lower_bound(trajectory, t_s, {}, &JointPoint::t_s);
  if (next == trajectory.begin()) return next->q_rad;
  if (next == trajectory.end()) return trajectory.back().q_rad;
  const JointPoint& from = *std::prev(next);
  const double share = (t_s - from.t_s) / (next->t_s - from.t_s);
  return from.q_rad + share * (next->q_rad - from.q_rad);
}

}  // namespace

Result<void> SimJointDriver::follow(const JointTrajectory& trajectory) {
  if (auto ok = check_trajectory(trajectory, q_rad_, WatchLimits()); !ok) return ok;
  return cell_.follow(trajectory.back().t_s, [&](double t_s) {
    q_rad_ = joints_at(trajectory, t_s);
    return robot_pose(arm_, q_rad_);
  });
}

sim_cell::RobotPose robot_pose(const motion::MountedArm& arm, const Joints& q_rad) {
  return {arm.model.T_base_flange(q_rad) * arm.parameters.T_flange_grasp,
          arm.model.link_poses(q_rad)};
}

}  // namespace graspd::agent
