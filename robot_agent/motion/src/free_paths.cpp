#include "free_paths.hpp"

#include <algorithm>
#include <array>

#include "free_search.hpp"
#include "graspd/motion/straight_path.hpp"

namespace graspd::motion {
namespace {

/// How far the arm rises, and comes from above, before a free way. 0 is not at all.
constexpr std::array kRises_m{0.0, 0.05, 0.10, 0.15};

JointPath reversed(JointPath path) {
  std::ranges::reverse(path.q_rad);
  std::ranges::reverse(path.tip_m);
  return path;
}

std::optional<std::string> touch_on(const PathTools& tools, const JointPath& path,
                                    const Posture& posture) {
  for (const agent::Joints& q_rad : path.q_rad) {
    if (auto touched = tools.world.touch(q_rad, posture)) return touched;
  }
  return std::nullopt;
}

/// Ways off one end of a free path: by `kRises_m` along a direction, as far as the arm can. Each
/// ends where nothing is near.
std::vector<JointPath> ways_off(const PathTools& tools, const agent::Joints& from_rad,
                                const Eigen::Vector3d& direction, const Posture& posture) {
  Posture guided = posture;
  guided.is_guided = true;
  std::vector<JointPath> ways;
  JointPath way{{from_rad}, {}};
  double risen_m = 0;
  for (const double rise_m : kRises_m) {
    if (rise_m > 0) {
      const Eigen::Isometry3d T_base_grasp = Eigen::Translation3d((rise_m - risen_m) * direction) *
                                             tools.T_base_grasp(way.q_rad.back());
      const auto next = tools.straight(way.q_rad.back(), T_base_grasp, guided);
      if (!next) break;
      way.append(*next);
      risen_m = rise_m;
    }
    if (!tools.world.touch(way.q_rad.back(), posture)) ways.push_back(way);
  }
  return ways;
}

struct Ends {
  std::vector<JointPath> off_start;
  std::vector<JointPath> off_goal;
};

Ends ends_of(const PathTools& tools, const agent::Joints& from_rad, const agent::Joints& to_rad,
             const Posture& posture) {
  const Eigen::Vector3d back_off = -tools.T_base_grasp(to_rad).linear().col(2);
  return {ways_off(tools, from_rad, Eigen::Vector3d::UnitZ(), posture),
          ways_off(tools, to_rad, back_off, posture)};
}

}  // namespace

Result<JointPath> PathTools::straight(const agent::Joints& from_rad,
                                      const Eigen::Isometry3d& T_base_goal,
                                      const Posture& posture) const {
  const StraightLine line{T_base_grasp(from_rad), T_base_goal, parameters.T_flange_grasp.inverse()};
  auto path = straight_path(ik, line, from_rad, arm.limits(), parameters.straight_step_m);
  if (!path) return path;
  double done_m = 0;
  for (std::size_t i = 1; i < path->q_rad.size(); ++i) {
    if (const auto touched = world.touch(path->q_rad[i], posture)) {
      return invalid("{}, after {:.0f} mm", *touched, 1000 * done_m);
    }
    done_m += path->tip_m[i - 1];
  }
  return path;
}

Result<JointPath> free_path(const PathTools& tools, const agent::Joints& from_rad,
                            const agent::Joints& to_rad, const Posture& posture) {
  JointPath direct = joint_line(from_rad, to_rad, tools.parameters.free_step_rad);
  const auto touched = touch_on(tools, direct, posture);
  if (!touched) return direct;
  const Ends ends = ends_of(tools, from_rad, to_rad, posture);
  for (const JointPath& off_start : ends.off_start) {
    for (const JointPath& off_goal : ends.off_goal) {
      const JointPath between =
          joint_line(off_start.q_rad.back(), off_goal.q_rad.back(), tools.parameters.free_step_rad);
      if (touch_on(tools, between, posture)) continue;
      JointPath path = off_start;
      path.append(between);
      path.append(reversed(off_goal));
      return path;
    }
  }
  return invalid("{}", *touched);
}

Result<JointPath> searched_path(const PathTools& tools, const agent::Joints& from_rad,
                                const agent::Joints& to_rad, const Posture& posture) {
  const Ends ends = ends_of(tools, from_rad, to_rad, posture);
  if (ends.off_start.empty() || ends.off_goal.empty()) {
    const bool at_start = ends.off_start.empty();
    const auto touched = tools.world.touch(at_start ? from_rad : to_rad, posture);
    return invalid("{} at the way's {}, and no height above it is free",
                   touched.value_or("the arm"), at_start ? "start" : "end");
  }
  const FreeSearch search{
      tools.arm.limits(),
      [&](const agent::Joints& q_rad) { return !tools.world.touch(q_rad, posture); },
      tools.parameters.free_step_rad, tools.parameters.max_tries_n};
  const auto corners_rad = find_free_way(search, ends.off_start.front().q_rad.back(),
                                         ends.off_goal.front().q_rad.back());
  if (!corners_rad) {
    return invalid("no way around was found in {} tries", tools.parameters.max_tries_n);
  }
  JointPath path = ends.off_start.front();
  for (std::size_t i = 1; i < corners_rad->size(); ++i) {
    path.append(
        joint_line((*corners_rad)[i - 1], (*corners_rad)[i], tools.parameters.free_step_rad));
  }
  path.append(reversed(ends.off_goal.front()));
  return path;
}

}  // namespace graspd::motion
