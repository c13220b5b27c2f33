#include "report.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>

#include "graspd/overlay/overlay.hpp"

namespace graspd::robot_agent {
namespace {

constexpr double kMillimetresPerMetre = 1e3;

std::string grasp_columns(const agent::ChosenGrasp& chosen) {
  const Eigen::Vector3d p_base_m = chosen.grasp.T_base_grasp.translation();
  const auto whole_mm = [](double length_m) {
    return std::lround(length_m * kMillimetresPerMetre);
  };
  return fmt::format("{:<13} {:>5} {:>5} {:>5}  {:>5.3f}  {:>5.1f}", chosen.part_id,
                     whole_mm(p_base_m.x()), whole_mm(p_base_m.y()), whole_mm(p_base_m.z()),
                     chosen.grs.grs, chosen.grasp.opening_width_m * kMillimetresPerMetre);
}

}  // namespace

std::string report_header() {
  return fmt::format(
      "{:<16} {:>5}  {:<16} {:>7} {:>6}  {:<13} {:>5} {:>5} {:>5}  {:>5}  {:>5}  {:>7}  {}", "cell",
      "frame", "outcome", "objects", "grasps", "first grasp", "x mm", "y mm", "z mm", "GRS", "w mm",
      "plan ms", "verdict");
}

std::string report_line(const std::string& cell, const agent::PickRecord& record) {
  const auto outcome = record.outcome ? name_of(*record.outcome) : name_of(record.code);
  std::string line = fmt::format("{:<16} {:>5}  {:<16} ", cell, record.frame_n, outcome);
  line += record.outcome ? fmt::format("{:>7} {:>6}  ", record.objects_n, record.grasps_n)
                         : fmt::format("{:>7} {:>6}  ", "-", "-");
  line += record.chosen ? grasp_columns(*record.chosen) : fmt::format("{:<44}", "-");
  line +=
      fmt::format("  {:>7.1f}  ", std::chrono::duration<double, std::milli>(record.plan).count());
  line += record.verdict ? name_of(*record.verdict) : "-";
  return record.message.empty() ? line : line + "  " + record.message;
}

Reporter::Reporter(std::string cell, record::RunRecorder recorder, std::filesystem::path overlays)
    : cell_(std::move(cell)), recorder_(std::move(recorder)), overlays_(std::move(overlays)) {
  // Where this fails, the first picture says so.
  std::error_code error;
  std::filesystem::create_directories(overlays_, error);
}

void Reporter::planned(std::uint64_t frame_n, const DepthFrame& frame, const PlanRequest& request,
                       const Result<PlanAnswer>& answer) {
  log_failure(recorder_.planned(frame_n, frame, request, answer));
  if (!answer) return;
  for (const std::string& warning : answer->warnings) spdlog::warn("{}: {}", cell_, warning);
  if (overlays_.empty()) return;
  const auto path = overlays_ / fmt::format("{:06}.png", frame_n);
  log_failure(overlay::write_png(path, overlay::draw(frame, request, *answer)));
}

void Reporter::finished(const agent::PickRecord& record) {
  for (const agent::PassedOver& over : record.passed_over) {
    spdlog::info("{}: frame {}: grasp {} of {} passed over: {}", cell_, record.frame_n, over.rank,
                 over.part_id, over.reason);
  }
  if (!record.alarm.empty()) spdlog::warn("{}: {}", cell_, record.alarm);
  fmt::print("{}\n", report_line(cell_, record));
  std::fflush(stdout);
  placed_n_ += record.verdict == agent::Verdict::kPlaced;
  log_failure(recorder_.finished(record));
}

void Reporter::ended(const agent::PickCycle& cycle) {
  const bool done = cycle.state() == agent::State::kDone;
  spdlog::log(done ? spdlog::level::info : spdlog::level::err, "{}: {}, {} parts placed: {}", cell_,
              done ? "done" : "stopped", placed_n_, cycle.reason());
  log_failure(
      recorder_.ended(name_of(cycle.state()), cycle.reason(), std::chrono::system_clock::now()));
}

void Reporter::log_failure(const Result<void>& written) const {
  if (!written) spdlog::error("{}: {}", cell_, written.error().message);
}

}  // namespace graspd::robot_agent
