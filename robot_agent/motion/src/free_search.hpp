#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "graspd/motion/arm_model.hpp"

namespace graspd::motion {

struct FreeSearch {
  std::span<const JointLimits> limits;
  std::function<bool(const agent::Joints&)> is_free;
  double step_rad = 0.05;  ///< between checks
  int max_tries_n = 0;
};

/// Corners of a way by OMPL's RRTConnect, shortened, both ends included; nothing where none was
/// found in so many tries. The same question has the same answer.
std::optional<std::vector<agent::Joints>> find_free_way(const FreeSearch& search,
                                                        const agent::Joints& from_rad,
                                                        const agent::Joints& to_rad);

}  // namespace graspd::motion
