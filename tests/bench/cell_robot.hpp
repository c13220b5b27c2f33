#pragma once

#include <memory>
#include <optional>

#include "graspd/motion/planned_arm.hpp"
#include "graspd/simulated/sim_cell.hpp"

/// The cell of `./run bench cell`: what stands where, and what moves the gripper.
namespace graspd::bench {

/// The bin's longer side lies across the arm's reach. \param seed of the sensor's noise
sim_cell::PhysicsCellOptions layout(int seed);

/// Where the gripper lets go.
Eigen::Isometry3d place_pose(const sim_cell::PhysicsCellOptions& cell);

/// A simulated cell, and the arm that the agent orders about in it.
struct CellRobot {
  std::unique_ptr<agent::SimCell> cell;
  std::unique_ptr<motion::PlannedArm> planned;  ///< none: the gripper floats

  agent::Arm& arm() { return planned ? static_cast<agent::Arm&>(*planned) : cell->floating_arm(); }
};

/// \param arm none: the gripper floats
Result<CellRobot> make_robot(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
                             const sim_cell::PhysicsCellOptions& options,
                             const std::optional<motion::ArmModel>& arm);

}  // namespace graspd::bench
