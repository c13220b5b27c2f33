#include "graspd/agent/motions.hpp"

namespace graspd::agent {

PickMotions pick_motions(const Grasp& grasp, const Eigen::Isometry3d& T_base_place) {
  const Eigen::Isometry3d& T_base_grasp = grasp.T_base_grasp;
  const auto back_off = Eigen::Translation3d(0, 0, -grasp.standoff_m);
  const auto up = Eigen::Translation3d(0, 0, grasp.retreat_m);
  return {{Step::kPreGrasp, Path::kFree, T_base_grasp * back_off},
          {Step::kApproach, Path::kStraight, T_base_grasp},
          {Step::kLift, Path::kStraight, up * T_base_grasp},
          {Step::kTransfer, Path::kFree, up * T_base_place},
          {Step::kPlace, Path::kStraight, T_base_place},
          {Step::kRetreat, Path::kStraight, up * T_base_place}};
}

}  // namespace graspd::agent
