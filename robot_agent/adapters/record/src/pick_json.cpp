#include "graspd/record/pick_json.hpp"

#include "json.hpp"

namespace graspd::record {
namespace {

double milliseconds(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

double seconds(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

Json grasp_json(const agent::ChosenGrasp& chosen) {
  const Grasp& grasp = chosen.grasp;
  const GrsTerms& grs = chosen.grs;
  return {{"pick", chosen.pick_n},
          {"rank", chosen.rank},
          {"part", chosen.part_id},
          {"object_id", grasp.object_id},
          {"pick_point", grasp.pick_point},
          {"T_base_grasp", row_major(grasp.T_base_grasp)},
          {"opening_width_m", grasp.opening_width_m},
          {"standoff_m", grasp.standoff_m},
          {"retreat_m", grasp.retreat_m},
          {"room_m", grasp.room_m},
          {"grs",
           {{"grs", grs.grs},
            {"p_self", grs.p_self},
            {"p_grasp", grs.p_grasp},
            {"p_system", grs.p_system},
            {"neighbour_ids", grs.neighbour_ids}}}};
}

Json passed_over_json(const std::vector<agent::PassedOver>& passed_over) {
  Json list = Json::array();
  for (const agent::PassedOver& over : passed_over) {
    list.push_back({{"rank", over.rank},
                    {"object_id", over.object_id},
                    {"part", over.part_id},
                    {"pick_point", over.pick_point},
                    {"reason", over.reason}});
  }
  return list;
}

Json timings_json(const agent::PickRecord& record) {
  Json timings;
  timings["acquire"] = milliseconds(record.acquire);
  timings["plan"] = milliseconds(record.plan);
  timings["choose"] = milliseconds(record.choose);
  if (record.chosen) {
    timings["pick"] = milliseconds(record.pick);
    timings["place"] = milliseconds(record.place);
  }
  if (record.stir.count() > 0) timings["stir"] = milliseconds(record.stir);
  if (!record.steps.empty()) timings["clear_view"] = milliseconds(record.clear_view);
  for (const auto& [step, duration] : record.steps) {
    timings["steps"].push_back({name_of(step), milliseconds(duration)});
  }
  for (const StageTiming& stage : record.server_timings) {
    timings["server"][stage.stage] = milliseconds(std::chrono::nanoseconds(stage.duration_ns));
  }
  return timings;
}

}  // namespace

std::string to_json(const agent::PickRecord& record) {
  Json line;
  line["frame"] = record.frame_n;
  line["start_s"] = seconds(record.start);
  line["end_s"] = seconds(record.end);
  if (!record.request_id.empty()) line["request_id"] = record.request_id;
  line["code"] = name_of(record.code);
  if (record.outcome) {
    line["outcome"] = name_of(*record.outcome);
    line["objects"] = record.objects_n;
    line["grasps"] = record.grasps_n;
  }
  if (!record.message.empty()) line["message"] = record.message;
  if (!record.alarm.empty()) line["alarm"] = record.alarm;
  if (!record.passed_over.empty()) line["passed_over"] = passed_over_json(record.passed_over);
  if (record.chosen) line["grasp"] = grasp_json(*record.chosen);
  if (record.verdict) line["verdict"] = name_of(*record.verdict);
  if (record.reaction) line["reaction"] = name_of(*record.reaction);
  line["ms"] = timings_json(record);
  return to_line(line);
}

}  // namespace graspd::record
