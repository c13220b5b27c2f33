#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "graspd/motion/arm_model.hpp"
#include "graspd/motion/inverse_kinematics.hpp"
#include "graspd/types/request.hpp"

namespace graspd::motion {

/// How an arm is mounted, what always stands around it, and how it may move.
struct MotionParameters {
  IkKind ik = IkKind::kAnno;
  /// The gripper on the flange. Mind that the Anno's flange has its z axis into the arm.
  Eigen::Isometry3d T_flange_grasp = Eigen::Isometry3d::Identity();
  Gripper gripper;
  /// Of a ball between the finger tips that stands for whatever part hangs there.
  double held_radius_m = 0.03;
  /// Whether the gripper may as well be turned by 180° about its approach.
  bool allow_turned_gripper = true;
  /// The table's top in base. Without it: the underside of the bin's floor, where there is a bin.
  std::optional<double> table_z_m;
  /// What parts are put into, where that has walls.
  std::optional<Bin> place_bin;
  /// Links keep this far from all they must not touch.
  double margin_m = 0.005;
  /// Edge of the columns that the cloud is taken for. What lies under a reading is unknown, and so
  /// occupied.
  double column_m = 0.01;

  double straight_step_m = 0.005;
  double max_straight_speed_m_s = 0.25;  ///< of the grasp frame
  double free_step_rad = 0.05;           ///< between checks of a free path
  double period_s = 0.02;                ///< between the points of a trajectory
  /// Of RRTConnect, where neither the direct way nor one from above is free. Counted in tries, not
  /// in time, so that the same question has the same answer.
  int max_tries_n = 2000;
};

}  // namespace graspd::motion
