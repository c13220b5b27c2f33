#pragma once

#include <memory>

#include "cell_config.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/motion/planned_arm.hpp"

namespace graspd::robot_agent {

/// The arm whose motions are planned here, with the cell's gripper.
/// \returns INVALID_ARGUMENT where the URDF is none, or has not as many joints as the posture out
/// of view.
Result<motion::MountedArm> load_arm(const CellConfig& config);

/// An arm with a controller of its own: its driver, and the arm that plans for it.
/// \returns UNAVAILABLE where the controller can't be reached, INVALID_ARGUMENT where it, or what
/// is said of the arm, does not fit.
Result<std::shared_ptr<agent::Arm>> make_driven_arm(const CellConfig& config);

}  // namespace graspd::robot_agent
