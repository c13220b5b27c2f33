#include "floating_arm.hpp"

#include <algorithm>

namespace graspd::agent {
namespace {

constexpr double kTurn_rad_s = 2;
/// Of a motion with smooth start and end: its top speed over its mean speed.
constexpr double kTopOverMean = 1.5;
constexpr double kLeast_m = 1e-4;

double smooth_step(double u) { return u * u * (3 - 2 * u); }

}  // namespace

void FloatingArm::set_surroundings(const Surroundings&) {}

std::optional<std::string> FloatingArm::why_not(std::span<const Motion> motions) {
  const auto ok = validate(motions);
  return ok ? std::nullopt : std::optional(ok.error().message);
}

Result<void> FloatingArm::move(const Motion& motion) {
  if (auto ok = validate(motion); !ok) return ok;
  return motion.path == Path::kStraight
             ? move_straight(motion.T_base_grasp, options_.straight_speed_m_s, motion.speed_share)
             : move_free(motion.T_base_grasp, motion.speed_share);
}

Result<void> FloatingArm::move_out_of_view() { return move_free(options_.T_base_out_of_view, 1); }

Result<void> FloatingArm::stop() { return {}; }

/// Up, across, and down again.
Result<void> FloatingArm::move_free(const Eigen::Isometry3d& T_base_grasp, double speed_share) {
  const auto lifted = [this](Eigen::Isometry3d T) {
    T.translation().z() = std::max(T.translation().z(), options_.safe_height_m);
    return T;
  };
  const auto go = [&](const Eigen::Isometry3d& T) {
    return move_straight(T, options_.free_speed_m_s, speed_share);
  };
  return go(lifted(cell_.T_base_grasp()))
      .and_then([&] { return go(lifted(T_base_grasp)); })
      .and_then([&] { return go(T_base_grasp); });
}

Result<void> FloatingArm::move_straight(const Eigen::Isometry3d& T_base_grasp, double speed_m_s,
                                        double speed_share) {
  const Eigen::Isometry3d from = cell_.T_base_grasp();
  const Eigen::Vector3d way_m = T_base_grasp.translation() - from.translation();
  const Eigen::Quaterniond q_from(from.linear()), q_to(T_base_grasp.linear());
  const double turn_rad = q_from.angularDistance(q_to);
  if (way_m.norm() < kLeast_m && turn_rad < kLeast_m) return {};
  const double duration_s =
      kTopOverMean * std::max(way_m.norm() / speed_m_s, turn_rad / kTurn_rad_s) / speed_share;
  return cell_.follow(duration_s, [&](double t_s) {
    const double s = smooth_step(t_s / duration_s);
    const Eigen::Translation3d p_m(from.translation() + s * way_m);
    return sim_cell::RobotPose{p_m * q_from.slerp(s, q_to), {}};
  });
}

}  // namespace graspd::agent
