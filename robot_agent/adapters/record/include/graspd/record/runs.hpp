#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::record {

/// One line of picks.jsonl, as far as statistics need it. What a frame did not come to is empty.
struct PickLine {
  std::uint64_t frame_n = 0;
  double start_s = 0;
  double end_s = 0;
  std::string code;
  std::string outcome;
  std::string message;
  std::string part;  ///< of the grasp that was chosen; without one it is no pick
  std::string verdict;
  std::vector<std::string> passed_over;  ///< the reasons
  bool is_alarmed = false;               ///< it raised the drift alarm
  std::vector<std::pair<std::string, double>>
      steps_ms;  ///< acquire, plan, choose, then the robot's

  bool is_pick() const { return !verdict.empty(); }
};

struct Run {
  std::filesystem::path folder;
  std::string cell;
  std::string state;  ///< RUNNING where it still runs, or was cut off
  std::string reason;
  std::vector<PickLine> picks;
};

/// All runs in a folder, however deep, by their folders' names.
///
/// A last line that was cut off in the middle is left out: the power failed, or the run goes on.
/// \returns INVALID_ARGUMENT where there is no run, or a line that is none, with its file and line.
Result<std::vector<Run>> read_runs(const std::filesystem::path& folder);

}  // namespace graspd::record
