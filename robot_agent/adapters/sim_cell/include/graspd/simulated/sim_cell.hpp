#pragma once

#include <memory>
#include <optional>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/arm_model.hpp"
#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::agent {

/// The arm that moves a simulated cell's gripper.
struct SimArm {
  motion::ArmModel model;
  Eigen::Isometry3d T_flange_grasp = Eigen::Isometry3d::Identity();
  Joints start_q_rad;
};

/// How a gripper without an arm moves.
struct FloatingOptions {
  double straight_speed_m_s = 0.25;
  double free_speed_m_s = 0.5;
  double safe_height_m = 0.25;  ///< of the grasp frame in base: free motions cross the cell there
  /// In base, where the camera does not look.
  Eigen::Isometry3d T_base_out_of_view = Eigen::Isometry3d::Identity();
};

/// A cell in physics behind the agent's ports. Time is the cell's own, and a plan takes as long as
/// it really takes; so the cycle's times are those of a real cell with this server. Belongs to one
/// thread. The ports live as long as the cell.
class SimCell {
 public:
  /// The meshes must outlive the cell. \param arm none: the gripper floats, by `floating`; the
  /// options' links and start are then left alone, else they are the arm's.
  SimCell(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
          sim_cell::PhysicsCellOptions options, std::optional<SimArm> arm,
          const FloatingOptions& floating);
  ~SimCell();
  SimCell(const SimCell&) = delete;
  SimCell& operator=(const SimCell&) = delete;

  /// Never ends.
  Camera& camera();
  Gripper& gripper();
  Clock& clock();
  /// What the arm is driven by; throws where there is none.
  JointDriver& joint_driver();
  /// The gripper without an arm, which gets anywhere; throws where there is an arm.
  Arm& floating_arm();
  /// The same planner, whose time passes in the cell too. It must outlive the cell.
  Planner& timed(Planner& planner);

  /// The truth: parts, traces, pictures.
  sim_cell::PhysicsCell& physics();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::agent
