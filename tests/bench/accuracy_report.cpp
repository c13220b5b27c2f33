#include "accuracy_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "graspd/eval/quantile.hpp"

namespace graspd::bench {
namespace {

constexpr double kMillimetre_m = 1e-3;

std::string median_of(const std::optional<eval::Spread>& error, double unit) {
  return error ? fmt::format("{:.2f}", error->median / unit) : "–";
}

/// A number that nothing was measured for is null.
nlohmann::json number(const std::optional<eval::Spread>& error, double eval::Spread::*value,
                      double unit) {
  return error ? nlohmann::json((*error).*value / unit) : nlohmann::json();
}

}  // namespace

Table accuracy_table() {
  return Table({"part", "objects", "answers", "recall", "precision", "AP", "error mm", "error deg",
                "median ms"});
}

std::vector<std::string> row_of(const std::string& name, const Measured& measured) {
  const eval::PoseAccuracy& accuracy = measured.accuracy;
  return {name,
          std::to_string(accuracy.objects_n()),
          std::to_string(accuracy.answers_n()),
          fmt::format("{:.3f}", accuracy.recall()),
          fmt::format("{:.3f}", accuracy.precision()),
          fmt::format("{:.3f}", accuracy.average_precision()),
          median_of(accuracy.translation_error_m(), kMillimetre_m),
          median_of(accuracy.rotation_error_rad(), kDegree_rad),
          measured.times_ms.empty()
              ? "–"
              : fmt::format("{:.1f}", eval::quantile(measured.times_ms, 0.5))};
}

void add_figures(const std::string& name, const Measured& measured, nlohmann::json& figures) {
  const eval::PoseAccuracy& accuracy = measured.accuracy;
  const auto translation_m = accuracy.translation_error_m();
  const auto rotation_rad = accuracy.rotation_error_rad();
  figures[name + ".objects"] = accuracy.objects_n();
  figures[name + ".answers"] = accuracy.answers_n();
  figures[name + ".recall"] = accuracy.recall();
  figures[name + ".precision"] = accuracy.precision();
  figures[name + ".ap"] = accuracy.average_precision();
  figures[name + ".error_mm_median"] = number(translation_m, &eval::Spread::median, kMillimetre_m);
  figures[name + ".error_mm_p90"] = number(translation_m, &eval::Spread::p90, kMillimetre_m);
  figures[name + ".error_deg_median"] = number(rotation_rad, &eval::Spread::median, kDegree_rad);
  figures[name + ".error_deg_p90"] = number(rotation_rad, &eval::Spread::p90, kDegree_rad);
  if (!measured.times_ms.empty()) {
    figures[name + ".frame_ms_1core"] = eval::quantile(measured.times_ms, 0.5);
  }
}

void add_targets(const std::vector<const parts::Part*>& parts, nlohmann::json& figures) {
  const auto worst = [&](const std::string& what) {
    double least = 1;
    for (const parts::Part* part : parts) {
      least = std::min(least, figures[part->id + "." + what].get<double>());
    }
    return least;
  };
  figures["recall_min"] = worst("recall");
  figures["precision_min"] = worst("precision");
  figures["ap_min"] = worst("ap");
  figures["error_mm_median"] = figures["all.error_mm_median"];
  figures["error_deg_median"] = figures["all.error_deg_median"];
  figures["frame_ms_1core"] = figures["all.frame_ms_1core"];
}

namespace {

/// Of answers to frames that do not show what was looked for.
struct FalseAnswers {
  std::size_t frames_n = 0;  ///< with any
  std::size_t answers_n = 0, likely_n = 0;
  double highest = 0;  ///< of their scores
};
/// As probable as not.
constexpr double kLikely = 0.5;

FalseAnswers count(const std::vector<std::vector<double>>& scores) {
  FalseAnswers result;
  for (const auto& of_frame : scores) {
    result.frames_n += !of_frame.empty();
    result.answers_n += of_frame.size();
    for (const double score : of_frame) {
      result.likely_n += score >= kLikely;
      result.highest = std::max(result.highest, score);
    }
  }
  return result;
}

}  // namespace

Table absent_table() {
  return Table({"absent", "frames", "with answers", "answers", "scored 0.5 or more", "highest"});
}

std::vector<std::string> absent_row(const std::string& name,
                                    const std::vector<std::vector<double>>& scores) {
  const FalseAnswers found = count(scores);
  return {name,
          std::to_string(scores.size()),
          std::to_string(found.frames_n),
          std::to_string(found.answers_n),
          std::to_string(found.likely_n),
          found.answers_n == 0 ? "–" : fmt::format("{:.2f}", found.highest)};
}

void add_absent_figures(const std::string& name, const std::vector<std::vector<double>>& scores,
                        nlohmann::json& figures) {
  const FalseAnswers found = count(scores);
  figures[name + ".frames"] = scores.size();
  figures[name + ".answers"] = found.answers_n;
  figures[name + ".likely_answers"] = found.likely_n;
  figures[name + ".score_max"] = found.highest;
}

nlohmann::json plot_of(const parts::Part& part, const eval::PoseAccuracy& accuracy) {
  nlohmann::json plot{{"part", part.id},
                      {"color_rgb", part.color_rgb},
                      {"ap", accuracy.average_precision()},
                      {"curve", nlohmann::json::array()},
                      {"visibility", nlohmann::json::array()}};
  for (const eval::CurvePoint& point : accuracy.curve()) {
    plot["curve"].push_back(
        {{"threshold", point.threshold}, {"precision", point.precision}, {"recall", point.recall}});
  }
  for (const eval::VisibilityBin& bin : accuracy.by_visibility()) {
    plot["visibility"].push_back({{"from", bin.from},
                                  {"to", bin.to},
                                  {"objects", bin.accuracy.objects_n()},
                                  {"found", bin.accuracy.found_n()}});
  }
  return plot;
}

Table record_table() {
  return Table({"part", "frame", "seed", "parts_in_frame", "camera_height_m", "camera_tilt_deg",
                "record", "score", "visible", "error_mm", "error_deg"});
}

void add_records(const eval::PoseAccuracy& accuracy, const Frame& frame,
                 const parts::Catalogue& catalogue, Table& records) {
  int parts_n = 0;
  const simulation::SceneOptions& scene = frame.scene;
  for (const simulation::PartCount& count : scene.parts) parts_n += count.count_n;
  const auto add = [&](int obj_id, std::string_view record, std::vector<std::string> numbers) {
    std::vector<std::string> row{catalogue.find_bop(obj_id)->id,
                                 std::to_string(frame.k),
                                 std::to_string(scene.seed + static_cast<std::uint64_t>(frame.k)),
                                 std::to_string(parts_n),
                                 fmt::format("{}", scene.camera_height_m),
                                 fmt::format("{:.0f}", scene.camera_tilt_rad / kDegree_rad),
                                 std::string(record)};
    row.insert(row.end(), numbers.begin(), numbers.end());
    records.add(std::move(row));
  };
  for (const eval::PosedAnswer& answer : accuracy.answers) {
    const bool hits = answer.verdict != eval::Verdict::kWrong;
    const auto of_hit = [&](double value) { return hits ? fmt::format("{:.3f}", value) : ""; };
    add(answer.obj_id, name_of(answer.verdict),
        {fmt::format("{:.4f}", answer.score), of_hit(answer.visible_fraction),
         of_hit(answer.error.translation_m / kMillimetre_m),
         of_hit(answer.error.rotation_rad / kDegree_rad)});
  }
  for (const eval::TrueObject& object : accuracy.objects) {
    if (object.is_found) continue;
    add(object.obj_id, "missed", {"", fmt::format("{:.3f}", object.visible_fraction), "", ""});
  }
}

}  // namespace graspd::bench
