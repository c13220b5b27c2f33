#pragma once

#include <chrono>

#include "graspd/types/answer.hpp"

namespace graspd::program {

/// Prints an answer, whole as JSON, or for people: the ranked grasps with the terms of their
/// scores, then outcome, funnel and timings.
void print_plan(const PlanAnswer& answer, bool as_json, std::chrono::nanoseconds round_trip);

}  // namespace graspd::program
