#include "graspd/motion/straight_path.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::motion {
namespace {

/// A step on which a joint turns further than this is a jump to another way of reaching the pose,
/// or comes too near to where there are endlessly many.
constexpr double kJump_rad = 0.3;
constexpr double kTurnStep_rad = 0.05;

}  // namespace

Result<JointPath> straight_path(InverseKinematics& ik, const StraightLine& line,
                                const agent::Joints& start_rad, std::span<const JointLimits> limits,
                                double step_m) {
  const Eigen::Vector3d from_m = line.T_base_start.translation();
  const Eigen::Vector3d way_m = line.T_base_end.translation() - from_m;
  const Eigen::Quaterniond from(line.T_base_start.linear());
  const Eigen::Quaterniond to(line.T_base_end.linear());
  const int steps_n =
      std::max({1, static_cast<int>(std::ceil(way_m.norm() / step_m)),
                static_cast<int>(std::ceil(from.angularDistance(to) / kTurnStep_rad))});
  JointPath path{{start_rad}, {}};
  for (int i = 1; i <= steps_n; ++i) {
    const double share = static_cast<double>(i) / steps_n;
    const Eigen::Isometry3d T_base_grasp =
        Eigen::Translation3d(from_m + share * way_m) * from.slerp(share, to);
    const double done_mm = 1000 * (share - 1.0 / steps_n) * way_m.norm();
    auto next_rad = ik.follow(T_base_grasp * line.T_grasp_flange, path.q_rad.back());
    if (!next_rad) return invalid("{}, after {:.0f} mm", next_rad.error().message, done_mm);
    int jumping = 0;
    const double turn_rad = (*next_rad - path.q_rad.back()).cwiseAbs().maxCoeff(&jumping);
    if (turn_rad > kJump_rad) {
      return invalid("{} would have to turn by {:.1f} rad at once, after {:.0f} mm",
                     limits[static_cast<std::size_t>(jumping)].name, turn_rad, done_mm);
    }
    path.q_rad.push_back(*std::move(next_rad));
    path.tip_m.push_back(way_m.norm() / steps_n);
  }
  return path;
}

}  // namespace graspd::motion
