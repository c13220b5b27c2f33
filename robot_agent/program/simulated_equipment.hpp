#pragma once

#include "equipment.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::robot_agent {

/// What stands where in a simulated cell.
sim_cell::PhysicsCellOptions layout(const CellConfig& config);

/// A pile in a simulated cell, whose arm picks it. Time is the cell's own.
Result<Equipment> make_simulated_equipment(const CellConfig& config);

}  // namespace graspd::robot_agent
