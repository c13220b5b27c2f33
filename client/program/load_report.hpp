#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "graspd/load/capacity.hpp"

namespace graspd::program {

/// What a load test came to.
struct LoadResult {
  std::vector<std::string> cells;
  double frame_bytes = 0;             ///< on the wire, the mean of the cells
  std::vector<load::Run> runs;        ///< by rate
  std::optional<double> capacity_hz;  ///< where it was looked for
};

/// One line about the last window, for whoever waits.
std::string progress_line(const load::Run& run);

/// For people. One run in detail, several as a table.
std::string load_report(const LoadResult& result);

/// What makes a result less than it seems, a sentence each: a rate that this machine could not
/// send, a run that was never stable, nothing answered.
std::vector<std::string> reservations(const LoadResult& result);

/// Writes load.json (the figures of each run), load.csv (a row for each request) and load.svg
/// (latency of each request over time; of several runs against the rate).
Result<void> write_load(const std::filesystem::path& folder, const LoadResult& result);

/// The picture of `write_load`.
std::string load_picture(const LoadResult& result);

}  // namespace graspd::program
