#pragma once

#include <numbers>

#include "graspd/agent/motions.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/motion_parameters.hpp"
#include "motion_support.hpp"

namespace graspd::testing {

/// An Anno with a gripper in front of a bin, as the tests of motions use it.
struct MotionCell {
  motion::ArmModel arm = anno();
  motion::MotionParameters parameters = mounted();
  agent::Surroundings around{bin(), {}};
  agent::Joints out_of_view_rad = joints({-1.57, 0.3, 0.3, 0, 0.97, 0});
  Eigen::Isometry3d T_base_place = down(0.05, 0.30, 0.06);

  static motion::MotionParameters mounted() {
    motion::MotionParameters parameters;
    // The tips are 0.12 m before the flange, whose z points into the arm.
    parameters.T_flange_grasp = Eigen::Translation3d(0, 0, -0.12) *
                                Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
    return parameters;
  }

  static Bin bin() {
    Bin bin;
    bin.T_base_bin.translation() = Eigen::Vector3d(0.31, 0, 0.005);
    bin.inner_size_m = Eigen::Vector3d(0.24, 0.24, 0.1);
    bin.wall_thickness_m = 0.005;
    return bin;
  }

  /// The gripper looks down, closing along the direction of yaw.
  static Eigen::Isometry3d down(double x_m, double y_m, double z_m, double yaw_rad = 0) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Eigen::Vector3d(x_m, y_m, z_m));
    T.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    T.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    return T;
  }

  Grasp grasp_at(const Eigen::Isometry3d& T_base_grasp) const {
    Grasp grasp;
    grasp.T_base_grasp = T_base_grasp;
    grasp.opening_width_m = 0.04;
    grasp.standoff_m = parameters.gripper.standoff_m;
    grasp.retreat_m = parameters.gripper.retreat_m;
    return grasp;
  }
  agent::PickMotions pick_at(const Eigen::Isometry3d& T_base_grasp) const {
    return agent::pick_motions(grasp_at(T_base_grasp), T_base_place);
  }

  Eigen::Isometry3d T_base_grasp(const agent::Joints& q_rad) const {
    return arm.T_base_flange(q_rad) * parameters.T_flange_grasp;
  }
};

}  // namespace graspd::testing
