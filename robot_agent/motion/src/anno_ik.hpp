#pragma once

#include <memory>

#include "graspd/motion/inverse_kinematics.hpp"

namespace graspd::motion {

/// Closed form for six joints built like the Anno's: two links in a plane that the first joint
/// turns, then a spherical wrist. The four lengths are taken from the model.
/// \returns INVALID_ARGUMENT where the arm is built in another way.
Result<std::unique_ptr<InverseKinematics>> make_anno_ik(const ArmModel& arm);

}  // namespace graspd::motion
