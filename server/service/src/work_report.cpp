#include "work_report.hpp"

#include <nlohmann/json.hpp>

namespace graspd::service {

using nlohmann::json;

WorkReport report_of(const Answer& answer) {
  const auto* plan = std::get_if<PlanAnswer>(&answer.body);
  if (plan == nullptr) return {answer.message, std::nullopt, 0, 0, {}};
  return {plan->reason, plan->outcome, plan->objects.size(), plan->grasps.size(), plan->timings};
}

std::string encode(const WorkReport& report) {
  json timings = json::array();
  for (const StageTiming& timing : report.timings) {
    timings.push_back({timing.stage, timing.duration_ns});
  }
  json out{{"message", report.message},
           {"objects_n", report.objects_n},
           {"grasps_n", report.grasps_n},
           {"timings", std::move(timings)}};
  if (report.outcome) out["outcome"] = name_of(*report.outcome);
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

WorkReport decode_work_report(std::string_view text) {
  const json in = json::parse(text);
  WorkReport report;
  report.message = in.at("message");
  report.objects_n = in.at("objects_n");
  report.grasps_n = in.at("grasps_n");
  for (const json& timing : in.at("timings")) {
    report.timings.push_back({timing.at(0), timing.at(1)});
  }
  if (in.contains("outcome")) {
    report.outcome = parse_enum<Outcome>(in.at("outcome").get<std::string>());
  }
  return report;
}

}  // namespace graspd::service
