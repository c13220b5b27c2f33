#pragma once

#include <filesystem>
#include <string>

#include "graspd/agent/pick_cycle.hpp"
#include "graspd/record/run_recorder.hpp"

namespace graspd::robot_agent {

/// The columns' names, and one pick as a line below them.
std::string report_header();
std::string report_line(const std::string& cell, const agent::PickRecord& record);

/// Tells people and files what happens: a line per frame on standard output, the run's records, an
/// overlay per plan. A full disk is logged, and no reason to stop picking.
class Reporter final : public agent::Observer {
 public:
  /// \param overlays a folder, or empty: none are drawn.
  Reporter(std::string cell, record::RunRecorder recorder, std::filesystem::path overlays);

  void planned(std::uint64_t frame_n, const DepthFrame& frame, const PlanRequest& request,
               const Result<PlanAnswer>& answer) override;
  void finished(const agent::PickRecord& record) override;

  /// The run is over: its last line in the log, and in its records.
  void ended(const agent::PickCycle& cycle);

 private:
  void log_failure(const Result<void>& written) const;

  std::string cell_;
  record::RunRecorder recorder_;
  std::filesystem::path overlays_;
  std::size_t placed_n_ = 0;
};

}  // namespace graspd::robot_agent
