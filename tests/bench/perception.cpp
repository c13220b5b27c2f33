/// graspd's perception and that of the open libraries on the same simulated Kinect v2 frames: time,
/// recall and precision, from clusters and from poses.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/quantile.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/perception/parameters.hpp"
#include "perception_runs.hpp"

namespace graspd::bench {
namespace {

/// One method over many frames.
struct Total {
  std::vector<double> times_ms;
  int objects_n = 0;
  int found_n = 0;
  int answers_n = 0;
  int right_n = 0;

  int frames_n() const { return static_cast<int>(times_ms.size()); }
  double median_ms() const { return eval::quantile(times_ms, 0.5); }
  double recall() const { return objects_n == 0 ? 0 : double(found_n) / objects_n; }
  double precision() const { return answers_n == 0 ? 0 : double(right_n) / answers_n; }
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
    sum.answers_n += run.answers_n.value_or(0);
    sum.right_n += run.right_n;
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

Table table_of(const std::vector<Run>& runs) {
  Table table({"task", "method", "frames", "recall %", "precision %", "median ms", "× graspd's ms",
               "graspd's recall %", "graspd's precision %"});
  for (const Method& method : methods_in(runs)) {
    const Total own = total(runs, method);
    const Total reference = reference_total(runs, method);
    const auto precision = [&](const Total& of) {
      return method.task == kPoses ? fmt::format("{:.1f}", of.precision() * 100) : "";
    };
    table.add({method.task, method.name, std::to_string(own.frames_n()),
               fmt::format("{:.1f}", own.recall() * 100), precision(own),
               fmt::format("{:.1f}", own.median_ms()),
               fmt::format("{:.2f}", own.median_ms() / reference.median_ms()),
               fmt::format("{:.1f}", reference.recall() * 100), precision(reference)});
  }
  return table;
}

Table raw_table(const std::vector<Run>& runs) {
  Table table({"part", "frame", "camera_height_m", "task", "method", "ms", "objects", "found",
               "answers", "right"});
  for (const Run& run : runs) {
    const bool has_answers = run.answers_n.has_value();
    table.add({run.part_id, std::to_string(run.frame), fmt::format("{}", run.camera_height_m),
               run.task, run.method, fmt::format("{:.3f}", run.time_ms),
               std::to_string(run.objects_n), std::to_string(run.found_n),
               has_answers ? std::to_string(*run.answers_n) : "",
               has_answers ? std::to_string(run.right_n) : ""});
  }
  return table;
}

nlohmann::json figures_of(const std::vector<Run>& runs, const parts::Catalogue& catalogue) {
  nlohmann::json figures;
  double peer_best_ratio = std::numeric_limits<double>::max();
  double peer_best_recall = 0;
  double peer_best_precision = 0;
  for (const Method& method : methods_in(runs)) {
    const Total own = total(runs, method);
    const std::string name = method.task + "." + method.name;
    figures[name + ".median_ms"] = own.median_ms();
    figures[name + ".recall"] = own.recall();
    if (method.task == kPoses) figures[name + ".precision"] = own.precision();
    if (!is_peer(method)) continue;
    peer_best_ratio =
        std::min(peer_best_ratio, own.median_ms() / reference_total(runs, method).median_ms());
    peer_best_recall = std::max(peer_best_recall, own.recall());
    peer_best_precision = std::max(peer_best_precision, own.precision());
  }
  double recall_min = 1;
  double precision_min = 1;
  for (const parts::Part& part : catalogue.parts()) {
    const Total own =
        total(runs, {kPoses, kGraspd}, [&](const Run& run) { return run.part_id == part.id; });
    recall_min = std::min(recall_min, own.recall());
    precision_min = std::min(precision_min, own.precision());
  }
  const auto median_ms = [&](const Method& method) { return total(runs, method).median_ms(); };
  figures["recall_min"] = recall_min;
  figures["precision_min"] = precision_min;
  figures["frame_ms_1core"] = median_ms({kPoses, kGraspd});
  figures["frame_ms_2core"] = median_ms({kPoses, kGraspd2});
  figures["pcl_euclidean_ms"] =
      median_ms({kSegmentation, std::string(name_of(Segmentation::kEuclidean))});
  figures["segmentation_ms"] = median_ms(reference_for({kSegmentation, ""}));
  figures["peer_best_ratio"] = peer_best_ratio;
  figures["peer_best_recall"] = peer_best_recall;
  figures["peer_best_precision"] = peer_best_precision;
  return figures;
}

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::filesystem::path out = "build/bench";
  PerceptionOptions measured;
};

void run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  const auto runs = measure(*catalogue, options.measured, [](const std::string& what) {
    std::cerr << "\r" << what << "   " << std::flush;
  });
  std::cerr << "\n";
  if (!runs) throw std::runtime_error(runs.error().message);
  std::cout << table_of(*runs).to_markdown();
  std::ofstream(options.out / "perception.csv") << raw_table(*runs).to_csv();
  std::ofstream(options.out / "perception.json") << figures_of(*runs, *catalogue).dump(2) << "\n";
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_perception", count, words, [&](CLI::App& app) {
    app.description(
        "graspd's perception beside PCL's, OpenCV's and Open3D's, on simulated frames.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--out", options.out, "folder for perception.json and perception.csv")
        ->capture_default_str();
    auto& measured = options.measured;
    app.add_option("--frames", measured.frames_n, "of each part")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--peer-frames", measured.peer_frames_n, "of these with the peers' pipelines")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--count", measured.parts_per_frame_n, "parts in a frame")
        ->capture_default_str();
    app.add_option("--seed", measured.seed, "of the first frame")->capture_default_str();
    app.callback([&] { graspd::bench::run(options); });
  });
}
