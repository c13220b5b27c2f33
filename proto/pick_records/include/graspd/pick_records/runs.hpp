#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/types/result.hpp"

/// What agents write down of their runs, read again: by whoever sums them up or shows them.
namespace graspd::pick_records {

/// A grasp that the arm could not take.
struct PassedOver {
  std::uint64_t rank = 0;  ///< from 1, of the answer's grasps
  std::string reason;
};

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
  std::string request_id;  ///< by which the server's log and flight recorder know it
  std::uint64_t rank = 0;  ///< of the grasp that was chosen, from 1
  std::vector<PassedOver> passed_over;
  bool is_alarmed = false;  ///< it raised the drift alarm
  std::vector<std::pair<std::string, double>>
      steps_ms;  ///< acquire, plan, choose, then the robot's

  bool is_pick() const { return !verdict.empty(); }
};

/// One run of one agent.
struct Run {
  std::filesystem::path folder;
  std::string cell;
  std::string state;  ///< RUNNING where it still runs, or was cut off
  std::string reason;
  std::vector<PickLine> picks;
};

/// \returns INVALID_ARGUMENT for what is no line of a picks.jsonl.
Result<PickLine> parse_pick_line(std::string_view json);

/// The run of a folder, without its picks.
/// \returns INVALID_ARGUMENT where its run.json is none.
Result<Run> read_run_state(const std::filesystem::path& folder);

/// Every folder with a picks.jsonl, however deep, by their names.
std::vector<std::filesystem::path> run_folders(const std::filesystem::path& folder);

/// All runs in a folder, however deep, by their folders' names.
///
/// A last line that was cut off in the middle is left out: the power failed, or the run goes on.
/// \returns INVALID_ARGUMENT where there is no run, or a line that is none, with its file and line.
Result<std::vector<Run>> read_runs(const std::filesystem::path& folder);

}  // namespace graspd::pick_records
