#pragma once

#include "equipment.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::robot_agent {

/// What stands where in a simulated cell.
sim_cell::PhysicsCellOptions layout(const CellConfig& config);

/// Its arm, with the cell's gripper.
/// \returns INVALID_ARGUMENT where the URDF is none, or has not as many joints as the posture out
/// of view.
Result<agent::SimArm> make_arm(const CellConfig& config);

/// A pile in a simulated cell, whose arm picks it. Time is the cell's own.
Result<Equipment> make_simulated_equipment(const CellConfig& config);

}  // namespace graspd::robot_agent
