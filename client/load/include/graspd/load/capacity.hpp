#pragma once

#include <functional>
#include <vector>

#include "graspd/load/run.hpp"

namespace graspd::load {

/// Answers that are OK come as fast as requests do, to 2 %: nothing is refused, and no queue grows.
/// And this machine could send them.
bool is_sustained(const Run& run);

/// What `find_capacity` found.
struct Capacity {
  double capacity_hz = 0;  ///< the highest rate that was tried and sustained; 0: none
  Run peak;                ///< in a closed loop
  std::vector<Run> runs;   ///< each rate that was tried, the lowest first
};

/// Looks for the highest rate that is sustained, to 2 %, beginning where a closed loop ends; then
/// runs at shares of it from a fifth to more than all, for latency against load.
/// \param run_at one run in an open loop of this rate
Capacity find_capacity(Run peak, const std::function<Run(double rate_hz)>& run_at);

}  // namespace graspd::load
