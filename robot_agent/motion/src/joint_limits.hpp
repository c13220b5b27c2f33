#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graspd/motion/arm_model.hpp"

namespace graspd::motion {

/// The way of the joint that has furthest to turn.
inline double furthest_turn(const agent::Joints& from_rad, const agent::Joints& to_rad) {
  return (to_rad - from_rad).cwiseAbs().maxCoeff();
}

/// Each joint by whole turns to where it is nearest to `near_rad`, within its limits where it can
/// be.
agent::Joints unwind(agent::Joints q_rad, const agent::Joints& near_rad,
                     std::span<const JointLimits> limits);

/// "joint_3 would be at 4.1 rad (limits -0.7 to 3.84)"; nothing where all are within.
std::optional<std::string> beyond_limits(const agent::Joints& q_rad,
                                         std::span<const JointLimits> limits);

/// Nearest to `near_rad` first, equal ones once.
void sort_by_nearness(std::vector<agent::Joints>& all_rad, const agent::Joints& near_rad);

}  // namespace graspd::motion
