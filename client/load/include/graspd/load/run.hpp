#pragma once

#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "graspd/load/pace.hpp"
#include "graspd/load/summary.hpp"

namespace graspd::load {

/// Requests at planned instants.
struct OpenLoad {
  /// Told when it starts.
  std::function<Pace(TimePoint start)> pace;
  double rate_hz = 0;  ///< of all cells together; 0 where the pace is not a rate
};
/// Each answer brings the next request.
struct ClosedLoad {
  int in_flight_n = 1;  ///< of each cell
};
using Load = std::variant<OpenLoad, ClosedLoad>;

/// A run warms up, then it is looked at in windows. It ends as soon as it is stable: goodput and
/// median latency of each of the last three windows are within 10 % of the three's mean. Otherwise
/// after `max_windows_n`.
struct RunOptions {
  std::chrono::duration<double> warm_up{2};
  std::chrono::duration<double> window{5};
  int max_windows_n = 10;
};

/// What was seen of one load.
struct Run {
  bool is_open = false;         ///< loop
  double rate_hz = 0;           ///< asked for; 0 where the load is not a rate
  std::vector<Sample> samples;  ///< every request, in the order they ended
  std::vector<Summary> windows;
  bool is_stable = false;
  double cpu_share = 0;  ///< of one core, by this process, while it asked
  /// Of the last three windows where they are stable, else of all; of every request where no window
  /// came to its end.
  Summary summary;
};

/// What a run is made with: `make` gives the cells' clients the run's own observer.
using GeneratorMaker = std::function<std::unique_ptr<Generator>(Observer)>;

/// \param progress called after each window, with its number
Run run_load(const GeneratorMaker& make, const Load& load, const RunOptions& options,
             const std::function<void(const Run&)>& progress);

/// The rule of RunOptions.
bool are_stable(const std::vector<Summary>& windows);

}  // namespace graspd::load
