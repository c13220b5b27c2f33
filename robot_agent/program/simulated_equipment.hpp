#pragma once

#include "equipment.hpp"

namespace graspd::robot_agent {

/// A pile in a simulated cell, whose arm picks it. Time is the cell's own.
Result<Equipment> make_simulated_equipment(const CellConfig& config);

}  // namespace graspd::robot_agent
