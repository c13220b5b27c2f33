#include "perception_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "graspd/eval/quantile.hpp"
#include "graspd/perception/parameters.hpp"

namespace graspd::bench {
namespace {

constexpr double kMillimetre_m = 1e-3;
constexpr double kDegree_rad = M_PI / 180;

/// One method over many frames.
struct Total {
  std::vector<double> times_ms;
  int objects_n = 0;
  int found_n = 0;
  eval::PoseAccuracy poses;

  double median_ms() const { return eval::quantile(times_ms, 0.5); }
  double recall() const { return objects_n == 0 ? 0 : double(found_n) / objects_n; }
};

struct Method {
  std::string task;
  std::string name;
  bool operator==(const Method&) const = default;
};

template <class Wanted>
Total total(const std::vector<Run>& runs, const Method& method, Wanted wanted) {
  Total sum;
  for (const Run& run : runs) {
    if (method != Method{run.task, run.method} || !wanted(run)) continue;
    sum.times_ms.push_back(run.time_ms);
    sum.objects_n += run.objects_n;
    sum.found_n += run.found_n;
    if (run.poses) sum.poses += *run.poses;
  }
  return sum;
}
Total total(const std::vector<Run>& runs, const Method& method) {
  return total(runs, method, [](const Run&) { return true; });
}

/// In the order of their first runs.
std::vector<Method> methods_in(const std::vector<Run>& runs) {
  std::vector<Method> methods;
  for (const Run& run : runs) {
    const Method method{run.task, run.method};
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) {
      methods.push_back(method);
    }
  }
  return methods;
}

/// What graspd does by default for the same task.
Method reference_for(const Method& method) {
  if (method.task == kPoses) return {kPoses, kGraspd};
  return {kSegmentation, std::string(name_of(perception::SegmentationParameters{}.method))};
}

/// The reference on the frames that a method ran on: the first ones of each part.
Total reference_total(const std::vector<Run>& runs, const Method& method) {
  int last = 0;
  for (const Run& run : runs) {
    if (method == Method{run.task, run.method}) last = std::max(last, run.frame);
  }
  return total(runs, reference_for(method), [&](const Run& run) { return run.frame <= last; });
}

bool is_peer(const Method& method) {
  return method.task == kPoses && method.name.rfind(kGraspd, 0) != 0;
}

std::string percent(double share) { return fmt::format("{:.1f}", share * 100); }

/// Recall, precision and AP; of segments there is recall alone.
std::array<std::string, 3> shares_of(const Method& method, const Total& total) {
  if (method.task != kPoses) return {percent(total.recall()), "", ""};
  return {percent(total.recall()), percent(total.poses.precision()),
          percent(total.poses.average_precision())};
}

/// The fastest peer over graspd on the same frames, and the best of each share.
void add_peers(const std::vector<Run>& runs, nlohmann::json& figures) {
  double ratio = std::numeric_limits<double>::max();
  double recall = 0;
  double precision = 0;
  double ap = 0;
  for (const Method& method : methods_in(runs)) {
    if (!is_peer(method)) continue;
    const Total own = total(runs, method);
    ratio = std::min(ratio, own.median_ms() / reference_total(runs, method).median_ms());
    recall = std::max(recall, own.recall());
    precision = std::max(precision, own.poses.precision());
    ap = std::max(ap, own.poses.average_precision());
  }
  figures["peer_best_ratio"] = ratio;
  figures["peer_best_recall"] = recall;
  figures["peer_best_precision"] = precision;
  figures["peer_best_ap"] = ap;
}

/// graspd's own accuracy: of the worst part, and errors over all.
void add_accuracy(const std::vector<Run>& runs, const parts::Catalogue& catalogue,
                  nlohmann::json& figures) {
  double recall_min = 1;
  double precision_min = 1;
  double ap_min = 1;
  for (const parts::Part& part : catalogue.parts()) {
    const Total own =
        total(runs, {kPoses, kGraspd}, [&](const Run& run) { return run.part_id == part.id; });
    recall_min = std::min(recall_min, own.poses.recall());
    precision_min = std::min(precision_min, own.poses.precision());
    ap_min = std::min(ap_min, own.poses.average_precision());
  }
  figures["recall_min"] = recall_min;
  figures["precision_min"] = precision_min;
  figures["ap_min"] = ap_min;
  const eval::PoseAccuracy all = total(runs, {kPoses, kGraspd}).poses;
  // Null where no answer is right.
  const auto median = [](const std::optional<eval::Spread>& error, double unit) {
    return error ? nlohmann::json(error->median / unit) : nlohmann::json();
  };
  figures["error_mm_median"] = median(all.translation_error_m(), kMillimetre_m);
  figures["error_deg_median"] = median(all.rotation_error_rad(), kDegree_rad);
}

}  // namespace

Table method_table(const std::vector<Run>& runs) {
  Table table({"task", "method", "frames", "recall %", "precision %", "AP %", "median ms",
               "× graspd's ms", "graspd's recall %", "graspd's precision %", "graspd's AP %"});
  for (const Method& method : methods_in(runs)) {
    const Total own = total(runs, method);
    const Total reference = reference_total(runs, method);
    const auto [recall, precision, ap] = shares_of(method, own);
    const auto [its_recall, its_precision, its_ap] = shares_of(method, reference);
    table.add({method.task, method.name, std::to_string(own.times_ms.size()), recall, precision, ap,
               fmt::format("{:.1f}", own.median_ms()),
               fmt::format("{:.2f}", own.median_ms() / reference.median_ms()), its_recall,
               its_precision, its_ap});
  }
  return table;
}

Table raw_table(const std::vector<Run>& runs) {
  Table table({"part", "frame", "camera_height_m", "task", "method", "ms", "objects", "found",
               "answers", "right"});
  for (const Run& run : runs) {
    table.add({run.part_id, std::to_string(run.frame), fmt::format("{}", run.camera_height_m),
               run.task, run.method, fmt::format("{:.3f}", run.time_ms),
               std::to_string(run.objects_n), std::to_string(run.found_n),
               run.poses ? std::to_string(run.poses->answers_n()) : "",
               run.poses ? std::to_string(run.poses->right_n()) : ""});
  }
  return table;
}

Table growth_table(const std::vector<GrowthRun>& runs) {
  Table table({"parts dropped", "in the bin", "visible by half", "answers", "points", "median ms",
               "ms a part"});
  for (const int asked_n : asked_numbers(runs)) {
    const GrowthRun median = median_of(runs, asked_n);
    table.add({std::to_string(asked_n), std::to_string(median.parts_n),
               std::to_string(median.visible_n), std::to_string(median.answers_n),
               std::to_string(median.points_n), fmt::format("{:.1f}", median.time_ms),
               fmt::format("{:.2f}", median.time_ms / median.parts_n)});
  }
  return table;
}

Table raw_growth_table(const std::vector<GrowthRun>& runs) {
  Table table({"parts_dropped", "parts", "visible", "answers", "points", "ms"});
  for (const GrowthRun& run : runs) {
    table.add({std::to_string(run.asked_n), std::to_string(run.parts_n),
               std::to_string(run.visible_n), std::to_string(run.answers_n),
               std::to_string(run.points_n), fmt::format("{:.3f}", run.time_ms)});
  }
  return table;
}

nlohmann::json figures_of(const std::vector<Run>& runs, const std::vector<GrowthRun>& growth,
                          const parts::Catalogue& catalogue) {
  nlohmann::json figures;
  for (const Method& method : methods_in(runs)) {
    const Total own = total(runs, method);
    const std::string name = method.task + "." + method.name;
    figures[name + ".median_ms"] = own.median_ms();
    figures[name + ".recall"] = own.recall();
    if (method.task != kPoses) continue;
    figures[name + ".precision"] = own.poses.precision();
    figures[name + ".ap"] = own.poses.average_precision();
  }
  const auto median_ms = [&](const Method& method) { return total(runs, method).median_ms(); };
  figures["frame_ms_1core"] = median_ms({kPoses, kGraspd});
  figures["frame_ms_2core"] = median_ms({kPoses, kGraspd2});
  figures["pcl_euclidean_ms"] =
      median_ms({kSegmentation, std::string(name_of(Segmentation::kEuclidean))});
  figures["segmentation_ms"] = median_ms(reference_for({kSegmentation, ""}));
  add_peers(runs, figures);
  add_accuracy(runs, catalogue, figures);
  figures["growth_exponent"] = growth_exponent(growth);
  return figures;
}

}  // namespace graspd::bench
