#pragma once

#include <memory>
#include <variant>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/planned_arm.hpp"
#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::agent {

/// How a gripper without an arm moves.
struct FloatingOptions {
  double straight_speed_m_s = 0.25;
  double free_speed_m_s = 0.5;
  double safe_height_m = 0.25;  ///< of the grasp frame in base: free motions cross the cell there
  /// In base, where the camera does not look, and where it is at first.
  Eigen::Isometry3d T_base_out_of_view = Eigen::Isometry3d::Identity();
};

/// A cell in physics behind the agent's ports. Time is the cell's own, and a plan takes as long as
/// it really takes; so the cycle's times are those of a real cell with this server. Belongs to one
/// thread. The ports live as long as the cell.
class SimCell {
 public:
  /// The meshes must outlive the cell. The options' links and start are the carrier's.
  /// \returns INVALID_ARGUMENT with what in the arm's parameters doesn't fit it.
  static Result<std::unique_ptr<SimCell>> create(
      const std::vector<parts::Mesh>& kinds, const simulation::Pile& pile,
      const sim_cell::PhysicsCellOptions& options,
      const std::variant<motion::MountedArm, FloatingOptions>& carrier);
  ~SimCell();
  SimCell(const SimCell&) = delete;
  SimCell& operator=(const SimCell&) = delete;

  /// Never ends.
  Camera& camera();
  /// Plans its motions; a floating gripper gets anywhere.
  Arm& arm();
  Gripper& gripper();
  Clock& clock();
  /// What the arm is driven by; throws where the gripper floats.
  JointDriver& joint_driver();
  /// The same planner, whose time passes in the cell too. It must outlive the cell.
  Planner& timed(Planner& planner);

  /// The truth: parts, traces, pictures.
  sim_cell::PhysicsCell& physics();

 private:
  struct Impl;
  explicit SimCell(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::agent
