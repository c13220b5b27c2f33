#pragma once

#include <vector>

#include "graspd/recorded/answer_diff.hpp"

namespace graspd::recorded {

/// The grasps of two answers that are not the same to the bit.
std::vector<GraspChange> grasp_changes(const PlanAnswer& before, const PlanAnswer& now);

}  // namespace graspd::recorded
