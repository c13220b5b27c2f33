#include "plan_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "graspd/codec/codec.hpp"
#include "graspd/formats/table.hpp"

namespace graspd::program {
namespace {

constexpr double kDegrees = 180 / M_PI;

std::string mm(double length_m) { return fmt::format("{:.1f}", length_m * 1e3); }

std::string ms(std::int64_t duration_ns) {
  return fmt::format("{:.1f}", static_cast<double>(duration_ns) / 1e6);
}

const Object* find(const PlanAnswer& answer, std::uint32_t id) {
  const auto found = std::find_if(answer.objects.begin(), answer.objects.end(),
                                  [id](const Object& object) { return object.id == id; });
  return found == answer.objects.end() ? nullptr : &*found;
}

/// How far the approach is from straight down, in degrees.
double tilt_deg(const Eigen::Isometry3d& T_base_grasp) {
  return std::acos(std::clamp(-T_base_grasp.linear()(2, 2), -1.0, 1.0)) * kDegrees;
}

/// Direction from jaw to jaw, seen from above, from base's x axis; jaws have no first and second.
double turn_deg(const Eigen::Isometry3d& T_base_grasp) {
  const Eigen::Vector3d closing = T_base_grasp.linear().col(0);
  const double angle = std::atan2(closing.y(), closing.x()) * kDegrees;
  return angle - 180 * std::round(angle / 180);
}

std::string count(std::size_t number, const std::string& noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

std::string checks_of(const Grasp& grasp) {
  const auto passed =
      std::count_if(grasp.checks.begin(), grasp.checks.end(),
                    [](const CheckReport& report) { return report.state == CheckState::kPassed; });
  return fmt::format("{} of {}", passed, grasp.checks.size());
}

/// Which checks no grasp can rely on, and why: the same for most grasps, hence once for all.
std::string checks_not_run(const PlanAnswer& answer) {
  std::set<std::string> sentences;
  for (const Grasp& grasp : answer.grasps) {
    for (const CheckReport& report : grasp.checks) {
      if (report.state != CheckState::kNotRun) continue;
      sentences.insert(fmt::format("{}{}{}", name_of(report.check),
                                   report.reason.empty() ? "" : ": ", report.reason));
    }
  }
  std::string text;
  for (const std::string& sentence : sentences) text += "not run   " + sentence + "\n";
  return text;
}

std::string list_of(const std::vector<std::uint32_t>& ids) {
  return ids.empty() ? "–" : fmt::format("{}", fmt::join(ids, " "));
}

/// What holds the object, or lies over it: a lift may take it along.
std::vector<std::uint32_t> comes_along(const Object& object) {
  std::set<std::uint32_t> ids(object.entangled_ids.begin(), object.entangled_ids.end());
  ids.insert(object.double_pick_ids.begin(), object.double_pick_ids.end());
  return {ids.begin(), ids.end()};
}

std::string grasp_table(const PlanAnswer& answer) {
  Table table({"rank", "object", "part", "GRS", "P_self", "P_grasp", "P_system", "under", "with",
               "x mm", "y mm", "z mm", "tilt °", "turn °", "open mm", "score", "checks"});
  for (std::size_t i = 0; i < answer.grasps.size(); ++i) {
    const Grasp& grasp = answer.grasps[i];
    const Object* object = find(answer, grasp.object_id);
    const GrsTerms grs = object ? object->grs : GrsTerms{};
    const Eigen::Vector3d p = grasp.T_base_grasp.translation();
    table.add({std::to_string(i + 1), std::to_string(grasp.object_id),
               object ? object->part_id : "–", fmt::format("{:.3f}", grs.grs),
               fmt::format("{:.3f}", grs.p_self), fmt::format("{:.4f}", grs.p_grasp),
               fmt::format("{:.2f}", grs.p_system), object ? list_of(object->supports_ids) : "–",
               object ? list_of(comes_along(*object)) : "–", mm(p.x()), mm(p.y()), mm(p.z()),
               fmt::format("{:.0f}", tilt_deg(grasp.T_base_grasp)),
               fmt::format("{:.0f}", turn_deg(grasp.T_base_grasp)), mm(grasp.opening_width_m),
               fmt::format("{:.3f}", grasp.score), checks_of(grasp)});
  }
  return table.to_text();
}

std::string rejected_table(const PlanAnswer& answer) {
  Table table({"object", "pick point", "rejected by", "because"});
  for (const Grasp& grasp : answer.rejected_grasps) {
    for (const CheckReport& report : grasp.checks) {
      if (report.state != CheckState::kFailed) continue;
      table.add({std::to_string(grasp.object_id), grasp.pick_point,
                 std::string(name_of(report.check)), report.reason});
    }
  }
  return table.to_text();
}

std::string funnel_line(const Funnel& funnel) {
  std::string line = fmt::format(
      "{} pixels → {} readings → {} inside → {} voxels → {} off the plane → {} segments → {} "
      "poses tried → {} parts → {} grasps",
      funnel.pixels_n, funnel.readings_n, funnel.after_passthrough_n, funnel.after_voxel_grid_n,
      funnel.after_plane_n, funnel.segments_n, funnel.hypotheses_n, funnel.registered_n,
      funnel.grasps_n);
  std::string rejected;
  for (std::size_t i = 0; i < funnel.rejected_by_check_n.size(); ++i) {
    if (funnel.rejected_by_check_n[i] == 0) continue;
    rejected += fmt::format("{}{} {}", rejected.empty() ? "" : ", ",
                            EnumNames<Check>::values[i].second, funnel.rejected_by_check_n[i]);
  }
  return rejected.empty() ? line : line + "; rejected by " + rejected;
}

std::string timings_line(const PlanAnswer& answer, std::chrono::nanoseconds round_trip) {
  std::string line;
  for (const StageTiming& timing : answer.timings) {
    line += fmt::format("{} {}, ", timing.stage, ms(timing.duration_ns));
  }
  return line + fmt::format("round trip {}", ms(round_trip.count()));
}

std::string plan_report(const PlanAnswer& answer, std::chrono::nanoseconds round_trip) {
  std::string text;
  if (!answer.grasps.empty()) {
    text += grasp_table(answer);
    text +=
        "under: objects that rest on it; with: objects that a lift may take along; tilt: of the "
        "approach from straight down; turn: of the closing direction from base x; checks: "
        "passed\n\n";
  }
  if (!answer.rejected_grasps.empty()) text += rejected_table(answer) + "\n";
  text += fmt::format("outcome   {}, {}, {}\n", name_of(answer.outcome),
                      count(answer.objects.size(), "object"), count(answer.grasps.size(), "grasp"));
  if (!answer.reason.empty()) text += fmt::format("reason    {}\n", answer.reason);
  for (const std::string& warning : answer.warnings) text += fmt::format("warning   {}\n", warning);
  if (answer.fill_level)
    text += fmt::format("fill      {:.0f} % of the bin\n", *answer.fill_level * 100);
  if (answer.bin_drift_m)
    text += fmt::format("drift     {:.1f} mm, of the bin's rim\n", *answer.bin_drift_m * 1e3);
  text += checks_not_run(answer);
  text += fmt::format("funnel    {}\n", funnel_line(answer.funnel));
  text += fmt::format("time ms   {}\n", timings_line(answer, round_trip));
  text += fmt::format("server    build {}, catalogue {}, config {}\n", answer.server.build,
                      answer.server.catalogue_hash, answer.server.config_hash);
  return text;
}

}  // namespace

void print_plan(const PlanAnswer& answer, bool as_json, std::chrono::nanoseconds round_trip) {
  if (as_json) {
    fmt::print("{}\n", codec::to_json(answer, true));
  } else {
    fmt::print("{}", plan_report(answer, round_trip));
  }
}

}  // namespace graspd::program
