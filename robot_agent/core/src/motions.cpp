#include "graspd/agent/motions.hpp"

namespace graspd::agent {

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
