#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graspd/load/generator.hpp"

namespace graspd::load {

/// What is kept of a request. Times are since its planned instant.
struct Sample {
  std::size_t cell = 0;
  double planned_s = 0;  ///< since the run's first window began; less than 0 in the warm-up
  Code code = Code::kOk;
  double handed_over_ms = 0;      ///< to the client: how late our own clock was
  std::optional<double> sent_ms;  ///< to a server's connection; none: there was none
  double ended_ms = 0;
  std::vector<StageTiming> timings;  ///< the server's, where OK
};

/// Of many values. All zero where there are none.
struct Quantiles {
  double p50 = 0;
  double p90 = 0;
  double p99 = 0;
  double p999 = 0;
  double most = 0;
};
/// \param values in any order; between two of them the lower one counts.
Quantiles quantiles_of(std::vector<double> values);

/// 1 where all have the same, 1/n where one has all. 1 where there is nothing to share.
double jain(const std::vector<double>& shares);

struct CellSummary {
  std::size_t asked_n = 0;
  std::size_t ok_n = 0;
  double goodput_hz = 0;
  Quantiles latency_ms;
};

/// What clients saw of a stretch of time: how the requests ended that were planned in it, and which
/// answers came in it. Where a queue grows, the two differ.
struct Summary {
  double length_s = 0;
  std::size_t asked_n = 0;
  std::size_t ok_n = 0;  ///< of those that were asked
  double asked_hz = 0;
  double sent_hz = 0;     ///< to a connection
  double goodput_hz = 0;  ///< answers that came and were OK
  std::map<Code, std::size_t> ended_n;
  Quantiles latency_ms;      ///< of what was OK, from the planned instant
  Quantiles clock_error_ms;  ///< planned instant to client: the load tool's own
  Quantiles sent_ms;         ///< planned instant to connection
  /// Where the mean latency went: waiting to be sent, transport (all that no server accounts for:
  /// network, encryption, encoding, the front), then the server's queue, decode and stages.
  std::vector<std::pair<std::string, double>> split_ms;
  std::vector<CellSummary> cells;
  double jain = 1;  ///< of the cells' goodput
};

/// \param samples of these cells, also from before and after
/// \param begin_s,end_s since the run's first window began
Summary summarise(const std::vector<Sample>& samples, double begin_s, double end_s,
                  std::size_t cells_n);

/// More than half of the requests were handed over too late to say that this rate was sent.
bool is_late(const Summary& summary);

}  // namespace graspd::load
