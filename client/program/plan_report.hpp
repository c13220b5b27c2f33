#pragma once

#include <chrono>
#include <string>

#include "graspd/types/answer.hpp"

namespace graspd::program {

/// What `grasp plan` prints of an answer: the ranked grasps with the terms of their scores, then
/// outcome, funnel and timings.
std::string plan_report(const PlanAnswer& answer, std::chrono::nanoseconds round_trip);

}  // namespace graspd::program
