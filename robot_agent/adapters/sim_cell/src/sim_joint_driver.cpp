#include "sim_joint_driver.hpp"

#include <algorithm>

namespace graspd::agent {
namespace {

constexpr double kAtStart_rad = 0.01;

Result<void> check(const JointTrajectory& trajectory, const Joints& q_rad) {
  if (trajectory.size() < 2) {
    return invalid("trajectory: {} points; give at least two", trajectory.size());
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Joints& point_rad = trajectory[i].q_rad;
    if (point_rad.size() != q_rad.size() || !point_rad.allFinite()) {
      return invalid("trajectory: point {} is not {} angles", i, q_rad.size());
    }
    const double previous_s = i == 0 ? 0 : trajectory[i - 1].t_s;
    if (i == 0 ? trajectory[i].t_s != 0 : !(trajectory[i].t_s > previous_s)) {
      return invalid(
          "trajectory: point {} is at {} s, the one before at {} s; times increase from 0", i,
          trajectory[i].t_s, previous_s);
    }
  }
  const double off_rad = (trajectory.front().q_rad - q_rad).cwiseAbs().maxCoeff();
  if (off_rad > kAtStart_rad) {
    return invalid("trajectory: starts {:.3f} rad from where the arm stands", off_rad);
  }
  return {};
}

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
  if (auto ok = check(trajectory, q_rad_); !ok) return ok;
  return cell_.follow(trajectory.back().t_s, [&](double t_s) {
    q_rad_ = joints_at(trajectory, t_s);
    return robot_pose(arm_, q_rad_);
  });
}

sim_cell::RobotPose robot_pose(const SimArm& arm, const Joints& q_rad) {
  return {arm.model.T_base_flange(q_rad) * arm.T_flange_grasp, arm.model.link_poses(q_rad)};
}

}  // namespace graspd::agent
