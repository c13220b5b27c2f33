#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "graspd/agent/pick_record.hpp"

namespace graspd::record {

/// Keeps all there is to know of a run, in a folder of its own:
///
///     run.json              the cell, when it ran, how it ended
///     picks.jsonl           one line per frame: outcome, grasps passed over, verdict, timings
///     frames/               the depth frames as a BOP scene, by frame number
///     requests/000000.json  what the server was asked, and
///     answers/000000.json   what it said, as `grasp plan --json` prints it
class RunRecorder {
 public:
  /// Makes the folder `runs`/CELL_2026-11-22T14-43-58Z; where there is one of that name, CELL_…-2.
  /// \returns INVALID_ARGUMENT where it can't be made.
  static Result<RunRecorder> create(const std::filesystem::path& runs, const std::string& cell,
                                    std::chrono::system_clock::time_point now, bool keep_frames);

  RunRecorder(RunRecorder&&) noexcept;
  RunRecorder& operator=(RunRecorder&&) noexcept;
  ~RunRecorder();

  const std::filesystem::path& folder() const;

  /// As of agent::Observer. \returns INTERNAL where the disk takes no more.
  Result<void> planned(std::uint64_t frame_n, const DepthFrame& frame, const PlanRequest& request,
                       const Result<PlanAnswer>& answer);
  /// Likewise; the line is in the file when this returns.
  Result<void> finished(const agent::PickRecord& record);
  /// \param state DONE or STOPPED. A run that never came to this says so in its run.json.
  Result<void> ended(std::string_view state, const std::string& reason,
                     std::chrono::system_clock::time_point now);

 private:
  struct Impl;
  explicit RunRecorder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::record
