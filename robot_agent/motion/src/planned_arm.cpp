#include "graspd/motion/planned_arm.hpp"

#include "joint_limits.hpp"

namespace graspd::motion {
namespace {

/// Controllers call a motion done when all joints are as near as this.
constexpr double kArrived_rad = 0.01;

bool same(const agent::Motion& a, const agent::Motion& b) {
  return a.step == b.step && a.path == b.path && a.speed_share == b.speed_share &&
         a.opening_width_m == b.opening_width_m &&
         a.T_base_grasp.matrix() == b.T_base_grasp.matrix();
}

}  // namespace

Result<std::unique_ptr<PlannedArm>> PlannedArm::create(agent::JointDriver& driver,
                                                       const MountedArm& arm) {
  if (arm.out_of_view_rad.size() != arm.model.joints_n()) {
    return invalid("out of view: {} joints for the arm '{}', which has {}",
                   arm.out_of_view_rad.size(), arm.model.name(), arm.model.joints_n());
  }
  if (const auto beyond = beyond_limits(arm.out_of_view_rad, arm.model.limits())) {
    return invalid("out of view: {}", *beyond);
  }
  auto planner = MotionPlanner::create(arm.model, arm.parameters);
  if (!planner) return tl::unexpected(planner.error());
  return std::unique_ptr<PlannedArm>(
      new PlannedArm(driver, *std::move(planner), arm.out_of_view_rad));
}

PlannedArm::PlannedArm(agent::JointDriver& driver, MotionPlanner planner,
                       agent::Joints out_of_view_rad)
    : driver_(driver), planner_(std::move(planner)), out_of_view_rad_(std::move(out_of_view_rad)) {}

void PlannedArm::set_surroundings(const agent::Surroundings& surroundings) {
  new_surroundings_ = surroundings;
  planned_.clear();
}

Result<agent::Joints> PlannedArm::look() {
  auto at_rad = driver_.joints();
  if (!at_rad) return at_rad;
  if (at_rad->size() != planner_.arm().joints_n()) {
    return invalid("the controller tells of {} joints, the arm '{}' has {}", at_rad->size(),
                   planner_.arm().name(), planner_.arm().joints_n());
  }
  if (new_surroundings_) planner_.set_surroundings(*new_surroundings_, *at_rad);
  new_surroundings_.reset();
  return at_rad;
}

Result<void> PlannedArm::plan(std::span<const agent::Motion> motions,
                              const agent::Joints& from_rad) {
  planned_.clear();
  auto trajectories = planner_.plan(motions, from_rad);
  if (!trajectories) return tl::unexpected(trajectories.error());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    planned_.push_back({motions[i], std::move((*trajectories)[i])});
  }
  return {};
}

std::optional<std::string> PlannedArm::why_not(std::span<const agent::Motion> motions) {
  const auto at_rad = look();
  if (!at_rad) return at_rad.error().message;
  if (const auto ok = plan(motions, *at_rad); !ok) return ok.error().message;
  return std::nullopt;
}

bool PlannedArm::is_next(const agent::Motion& motion, const agent::Joints& at_rad) const {
  return !planned_.empty() && same(planned_.front().motion, motion) &&
         furthest_turn(planned_.front().trajectory.front().q_rad, at_rad) < kArrived_rad;
}

Result<void> PlannedArm::move(const agent::Motion& motion) {
  const auto at_rad = look();
  if (!at_rad) return tl::unexpected(at_rad.error());
  if (!is_next(motion, *at_rad)) {
    if (auto ok = plan({&motion, 1}, *at_rad); !ok) return ok;
  }
  const Planned next = std::move(planned_.front());
  planned_.pop_front();
  return follow(next.trajectory);
}

Result<void> PlannedArm::move_out_of_view() {
  planned_.clear();
  const auto at_rad = look();
  if (!at_rad) return tl::unexpected(at_rad.error());
  const auto trajectory = planner_.plan_to(out_of_view_rad_, *at_rad);
  if (!trajectory) {
    return invalid("{}: {}", name_of(agent::Step::kOutOfView), trajectory.error().message);
  }
  return follow(*trajectory);
}

Result<void> PlannedArm::follow(const agent::JointTrajectory& trajectory) {
  auto done = driver_.follow(trajectory);
  if (!done) planned_.clear();
  return done;
}

Result<void> PlannedArm::stop() {
  planned_.clear();
  return driver_.stop();
}

}  // namespace graspd::motion
