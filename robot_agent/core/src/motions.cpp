#include "graspd/agent/motions.hpp"

#include <cmath>

namespace graspd::agent {

Result<void> validate(const Motion& motion) {
  const auto step = name_of(motion.step);
  const Eigen::Matrix3d R = motion.T_base_grasp.linear();
  if (!motion.T_base_grasp.matrix().allFinite() || !R.isUnitary(1e-4) || R.determinant() < 0) {
    return invalid(
        "{}: where the gripper is to go is no pose: numbers that are not finite, or no "
        "rotation",
        step);
  }
  if (!(motion.speed_share > 0 && motion.speed_share <= 1)) {
    return invalid("{}: a share of {} of the speed; give one above 0 and at most 1", step,
                   motion.speed_share);
  }
  if (!(motion.opening_width_m >= 0 && std::isfinite(motion.opening_width_m))) {
    return invalid("{}: jaws that are {} m apart; give a width from 0 up", step,
                   motion.opening_width_m);
  }
  return {};
}

Result<void> validate(std::span<const Motion> motions) {
  for (const Motion& motion : motions) {
    if (auto ok = validate(motion); !ok) return ok;
  }
  return {};
}

PickMotions pick_motions(const Grasp& grasp, const Eigen::Isometry3d& T_base_place) {
  const Eigen::Isometry3d& T_base_grasp = grasp.T_base_grasp;
  const auto back_off = Eigen::Translation3d(0, 0, -grasp.standoff_m);
  const auto up = Eigen::Translation3d(0, 0, grasp.retreat_m);
  const auto motion = [&](Step step, Path path, const Eigen::Isometry3d& T) {
    return Motion{step, path, T, 1, grasp.opening_width_m};
  };
  return {motion(Step::kPreGrasp, Path::kFree, T_base_grasp * back_off),
          motion(Step::kApproach, Path::kStraight, T_base_grasp),
          motion(Step::kLift, Path::kStraight, up * T_base_grasp),
          motion(Step::kTransfer, Path::kFree, up * T_base_place),
          motion(Step::kPlace, Path::kStraight, T_base_place),
          motion(Step::kRetreat, Path::kStraight, up * T_base_place)};
}

}  // namespace graspd::agent
