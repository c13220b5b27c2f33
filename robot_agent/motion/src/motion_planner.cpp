#include "graspd/motion/motion_planner.hpp"

#include <algorithm>
#include <numbers>

#include "free_paths.hpp"
#include "joint_limits.hpp"

namespace graspd::motion {
namespace {

using agent::Motion;

/// Candidates that RRTConnect is asked for, since each costs as much as all the rest.
constexpr std::size_t kSearches = 2;

Posture posture_of(const Motion& motion) {
  return {motion.opening_width_m, motion.step == agent::Step::kTransfer,
          motion.path == agent::Path::kStraight};
}

/// Which motion can't be done, counted from the group's first, and why.
struct Failure {
  std::size_t motion = 0;
  std::string why;

  void note(std::size_t at, const std::string& reason) {
    if (!why.empty() && at <= motion) return;
    motion = at;
    why = reason;
  }
};

/// A way to reach a free motion's goal, from which the straight ones can be done that follow.
struct Candidate {
  agent::Joints goal_rad;
  std::vector<JointPath> straight;
};

Result<void> check(const MotionParameters& of) {
  if (!(of.straight_step_m > 0) || !(of.max_straight_speed_m_s > 0) || !(of.free_step_rad > 0) ||
      !(of.period_s > 0) || !(of.column_m > 0)) {
    return invalid("motion: steps, speed, period and column must be above 0");
  }
  if (of.margin_m < 0 || of.max_tries_n < 0) {
    return invalid("motion: margin_m and max_tries_n must not be negative");
  }
  return {};
}

}  // namespace

struct MotionPlanner::Impl {
  Impl(ArmModel arm_model, const MotionParameters& of, std::unique_ptr<InverseKinematics> solver)
      : arm(std::move(arm_model)), parameters(of), ik(std::move(solver)), world(arm, parameters) {}

  /// The gripper as it is asked for, and turned about its approach.
  std::vector<Eigen::Isometry3d> ways_to_hold(const Eigen::Isometry3d& T_base_grasp) const {
    std::vector<Eigen::Isometry3d> ways{T_base_grasp};
    if (parameters.allow_turned_gripper) {
      ways.push_back(T_base_grasp * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
    }
    return ways;
  }

  Result<std::vector<agent::Joints>> joints_for(const Eigen::Isometry3d& T_base_grasp,
                                                const agent::Joints& near_rad) {
    return ik->solve(T_base_grasp * parameters.T_flange_grasp.inverse(), near_rad);
  }

  /// Joints for either way to hold, nearest first.
  std::vector<agent::Joints> goals(const Motion& motion, const agent::Joints& near_rad) {
    std::vector<agent::Joints> all_rad;
    for (const Eigen::Isometry3d& T : ways_to_hold(motion.T_base_grasp)) {
      if (const auto found_rad = joints_for(T, near_rad)) {
        all_rad.insert(all_rad.end(), found_rad->begin(), found_rad->end());
      }
    }
    sort_by_nearness(all_rad, near_rad);
    return all_rad;
  }

  Result<void> check_start(const agent::Joints& from_rad) const {
    if (const auto beyond = beyond_limits(from_rad, arm.limits())) {
      return invalid("the arm stands beyond its limits: {}: move it back by hand", *beyond);
    }
    return {};
  }

  /// The quick answer for what is out of reach, before anything else is computed.
  Result<void> check_reach(std::span<const Motion> motions, const agent::Joints& from_rad) {
    for (const Motion& motion : motions) {
      std::string why;
      const auto can_reach = [&](const Eigen::Isometry3d& T_base_grasp) {
        const auto found = joints_for(T_base_grasp, from_rad);
        if (!found && why.empty()) why = found.error().message;
        return found.has_value();
      };
      if (std::ranges::none_of(ways_to_hold(motion.T_base_grasp), can_reach)) {
        return invalid("{}: out of reach: {}", name_of(motion.step), why);
      }
    }
    return {};
  }

  /// One after the other; of the gripper's two ways the one that the arm is in.
  Result<std::vector<JointPath>> straight_paths(std::span<const Motion> motions,
                                                agent::Joints at_rad, Failure& failure,
                                                std::size_t first) {
    std::vector<JointPath> paths;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const Eigen::Quaterniond now(tools().T_base_grasp(at_rad).linear());
      const auto ways = ways_to_hold(motions[i].T_base_grasp);
      const auto& T = *std::ranges::min_element(ways, {}, [&](const Eigen::Isometry3d& way) {
        return now.angularDistance(Eigen::Quaterniond(way.linear()));
      });
      auto path = tools().straight(at_rad, T, posture_of(motions[i]));
      if (!path) {
        failure.note(first + i, path.error().message);
        return tl::unexpected(path.error());
      }
      at_rad = path->q_rad.back();
      paths.push_back(*std::move(path));
    }
    return paths;
  }

  /// A free motion and the straight ones that follow it.
  Result<std::vector<JointPath>> free_group(std::span<const Motion> group,
                                            const agent::Joints& from_rad, Failure& failure) {
    const Posture posture = posture_of(group.front());
    Posture guided = posture;
    guided.is_guided = true;
    std::vector<Candidate> candidates;
    const auto done = [](JointPath path, std::vector<JointPath> straight) {
      straight.insert(straight.begin(), std::move(path));
      return straight;
    };
    const auto goals_rad = goals(group.front(), from_rad);
    if (goals_rad.empty()) failure.note(0, "out of reach from there");
    for (const agent::Joints& goal_rad : goals_rad) {
      if (const auto touched = world.touch(goal_rad, guided)) {
        failure.note(0, *touched);
        continue;
      }
      auto straight = straight_paths(group.subspan(1), goal_rad, failure, 1);
      if (!straight) continue;
      auto path = free_path(tools(), from_rad, goal_rad, posture);
      if (path) return done(*std::move(path), *std::move(straight));
      failure.note(0, path.error().message);
      candidates.push_back({goal_rad, *std::move(straight)});
    }
    for (std::size_t i = 0; i < std::min(kSearches, candidates.size()); ++i) {
      auto path = searched_path(tools(), from_rad, candidates[i].goal_rad, posture);
      if (path) return done(*std::move(path), std::move(candidates[i].straight));
      failure = {0, path.error().message};
    }
    return invalid("{}", failure.why);
  }

  Result<std::vector<agent::JointTrajectory>> plan(std::span<const Motion> motions,
                                                   agent::Joints at_rad) {
    if (const auto ok = check_start(at_rad); !ok) return tl::unexpected(ok.error());
    if (const auto ok = validate(motions); !ok) return tl::unexpected(ok.error());
    if (const auto ok = check_reach(motions, at_rad); !ok) return tl::unexpected(ok.error());
    std::vector<agent::JointTrajectory> trajectories;
    for (std::size_t begin = 0; begin < motions.size();) {
      const auto is_free = [](const Motion& motion) { return motion.path == agent::Path::kFree; };
      const std::size_t end = static_cast<std::size_t>(
          std::find_if(motions.begin() + static_cast<std::ptrdiff_t>(begin) + 1, motions.end(),
                       is_free) -
          motions.begin());
      const auto group = motions.subspan(begin, end - begin);
      Failure failure;
      const auto paths = is_free(group.front()) ? free_group(group, at_rad, failure)
                                                : straight_paths(group, at_rad, failure, 0);
      if (!paths) return invalid("{}: {}", name_of(group[failure.motion].step), failure.why);
      for (std::size_t i = 0; i < group.size(); ++i) {
        trajectories.push_back(timed((*paths)[i], group[i].speed_share));
      }
      at_rad = paths->back().q_rad.back();
      begin = end;
    }
    return trajectories;
  }

  agent::JointTrajectory timed(const JointPath& path, double speed_share) const {
    std::vector<JointLimits> limits(arm.limits().begin(), arm.limits().end());
    for (JointLimits& of : limits) of.max_velocity_rad_s *= speed_share;
    return time_parameterise(path, limits, speed_share * parameters.max_straight_speed_m_s,
                             parameters.period_s);
  }

  PathTools tools() { return {arm, parameters, *ik, world}; }

  ArmModel arm;
  MotionParameters parameters;
  std::unique_ptr<InverseKinematics> ik;
  CollisionWorld world;
};

MotionPlanner::MotionPlanner(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MotionPlanner::~MotionPlanner() = default;
MotionPlanner::MotionPlanner(MotionPlanner&&) noexcept = default;

Result<MotionPlanner> MotionPlanner::create(const ArmModel& arm,
                                            const MotionParameters& parameters) {
  if (const auto ok = check(parameters); !ok) return tl::unexpected(ok.error());
  auto ik = make_inverse_kinematics(parameters.ik, arm);
  if (!ik) return tl::unexpected(ik.error());
  return MotionPlanner(std::make_unique<Impl>(arm, parameters, *std::move(ik)));
}

const ArmModel& MotionPlanner::arm() const { return impl_->arm; }

void MotionPlanner::set_surroundings(const agent::Surroundings& surroundings,
                                     const agent::Joints& standing_rad) {
  impl_->world.set_surroundings(surroundings, standing_rad);
}

Result<std::vector<agent::JointTrajectory>> MotionPlanner::plan(std::span<const Motion> motions,
                                                                const agent::Joints& from_rad) {
  return impl_->plan(motions, from_rad);
}

Result<agent::JointTrajectory> MotionPlanner::plan_to(const agent::Joints& to_rad,
                                                      const agent::Joints& from_rad) {
  if (const auto ok = impl_->check_start(from_rad); !ok) return tl::unexpected(ok.error());
  const Posture posture{impl_->parameters.gripper.max_opening_m};
  auto path = free_path(impl_->tools(), from_rad, to_rad, posture);
  if (!path) path = searched_path(impl_->tools(), from_rad, to_rad, posture);
  if (!path) return tl::unexpected(path.error());
  return impl_->timed(*path, 1);
}

}  // namespace graspd::motion
