#include "log_line.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace graspd::service {
namespace {

using nlohmann::ordered_json;

/// To a microsecond.
double ms(std::chrono::nanoseconds duration) {
  return std::round(static_cast<double>(duration.count()) / 1e3) / 1e3;
}

/// Bytes that are no UTF-8 are replaced, so that every line can be read.
std::string text_of(const ordered_json& line) {
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json frame_fields(const FrameDescription& frame) {
  return {{"width_px", frame.camera.width_px},
          {"height_px", frame.camera.height_px},
          {"depth_scale_m", frame.depth_scale_m},
          {"encoding", name_of(frame.encoding)},
          {"bytes", frame.payload_bytes},
          {"crc32", fmt::format("{:08x}", frame.payload_crc32)}};
}

ordered_json stages_of(const std::vector<StageTiming>& timings) {
  ordered_json stages = ordered_json::object();
  for (const StageTiming& timing : timings) {
    stages[timing.stage] = ms(std::chrono::nanoseconds(timing.duration_ns));
  }
  return stages;
}

}  // namespace

std::string log_line(std::string_view message) { return text_of({{"message", message}}); }

std::string log_line(const PlanJob& plan, const RequestEnd& end, const ServerInfo& server) {
  ordered_json line{{"request_id", hexadecimal(plan.id)},
                    {"attempt", plan.attempt},
                    {"cell", plan.cell},
                    {"parts", plan.parts},
                    {"code", name_of(end.code)}};
  if (end.report.outcome) {
    line["outcome"] = name_of(*end.report.outcome);
    line["objects_n"] = end.report.objects_n;
    line["grasps_n"] = end.report.grasps_n;
  }
  if (!end.report.message.empty()) line["message"] = end.report.message;
  line["budget_ms"] = plan.budget.count();
  line["queue_ms"] = ms(end.queued);
  line["total_ms"] = ms(end.taken);
  if (!end.report.timings.empty()) line["stages_ms"] = stages_of(end.report.timings);
  line["frame"] = frame_fields(plan.frame);
  line["build"] = server.build;
  line["catalogue_hash"] = server.catalogue_hash;
  line["config_hash"] = server.config_hash;
  if (!end.recorded.empty()) line["recorded"] = end.recorded.string();
  return text_of(line);
}

std::string log_line(const Refused& refused) {
  ordered_json line{{"request_id", hexadecimal(refused.id)}};
  if (!refused.cell.empty()) line["cell"] = refused.cell;
  line["code"] = name_of(refused.error.code);
  line["message"] = refused.error.message;
  return text_of(line);
}

}  // namespace graspd::service
