#pragma once

#include <filesystem>
#include <string>

#include "graspd/agent/pick_record.hpp"
#include "graspd/record/json_lines.hpp"

namespace graspd::robot_agent {

/// The columns' names, and one pick as a line below them.
std::string report_header();
std::string report_line(const std::string& cell, const agent::PickRecord& record);

/// Tells people and files what happens: a line per pick on standard output, a JSON line per pick,
/// an overlay per plan. A full disk is logged, and no reason to stop picking.
class Reporter final : public agent::Observer {
 public:
  /// \param overlays a folder, or empty: none are drawn.
  Reporter(std::string cell, record::JsonLines picks, std::filesystem::path overlays);

  void planned(std::uint64_t frame_n, const DepthFrame& frame, const PlanRequest& request,
               const PlanAnswer& answer) override;
  void finished(const agent::PickRecord& record) override;

  std::size_t placed_n() const { return placed_n_; }

 private:
  std::string cell_;
  record::JsonLines picks_;
  std::filesystem::path overlays_;
  std::size_t placed_n_ = 0;
};

}  // namespace graspd::robot_agent
