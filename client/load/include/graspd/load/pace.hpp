#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "graspd/load/generator.hpp"

/// Open loop: requests are due at planned instants, whether or not earlier ones have ended.
namespace graspd::load {

/// One request of an open loop.
struct Due {
  TimePoint at;
  std::size_t cell = 0;
};
/// Tells what is due next, in the order of time, without end.
using Pace = std::function<Due()>;

/// Cells take turns, at equal distances.
Pace fixed_pace(TimePoint start, double rate_hz, std::size_t cells_n);
/// Each cell asks at random instants of its own, independent of what was before.
Pace poisson_pace(TimePoint start, double rate_hz, std::size_t cells_n, std::uint64_t seed);
/// Each cell asks when its frames were recorded, over and over; all cells begin at once.
/// \param stamps_s of each cell, in the recording's own time
/// \throws std::invalid_argument where a cell has fewer than two, or they don't grow.
Pace recorded_pace(TimePoint start, std::vector<std::vector<double>> stamps_s);

/// Asks at the instants of `pace` until `go_on` says no of one. Takes the thread as its clock.
void run_open_loop(Generator& generator, const Pace& pace,
                   const std::function<bool(const Due&)>& go_on);

}  // namespace graspd::load
