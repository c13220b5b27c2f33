#pragma once

#include <memory>

#include "graspd/motion/inverse_kinematics.hpp"

namespace graspd::motion {

/// Levenberg-Marquardt from a fixed set of starts: the same answers for the same questions. It does
/// not find every branch.
std::unique_ptr<InverseKinematics> make_kdl_ik(const ArmModel& arm);

}  // namespace graspd::motion
