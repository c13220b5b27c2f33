/// How often a plan asks the heap for memory, stage by stage, once it has planned before.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "allocation_count.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/quantile.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/perception/planner.hpp"
#include "piles.hpp"

namespace graspd::bench {
namespace {

constexpr std::array kStages{"preprocess", "segmentation", "registration", "grasps", "all"};

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::filesystem::path out = "build/bench";
  int parts_per_frame_n = 45;
  int frames_n = 2;
  int warm_up_n = 2;
  std::uint64_t seed = 1;
};

using ByStage = std::array<AllocationCount, kStages.size()>;

/// The planner asks whether it is late after preprocessing, after segmentation, many times while it
/// registers, and once more after it planned grasps. Takes nothing from the heap itself.
class StageCounter {
 public:
  perception::IsLate ask() {
    return [this] {
      before_last_ = std::exchange(last_, allocations());
      if (asked_n_ < 2) ends_[asked_n_] = last_;
      ++asked_n_;
      return false;
    };
  }
  /// \throws std::runtime_error where the plan did not come to its last stage.
  ByStage counts(const AllocationCount& begin, const AllocationCount& end) const {
    if (asked_n_ < 4) throw std::runtime_error("a plan ended before it had registered parts");
    return {ends_[0] - begin, ends_[1] - ends_[0], before_last_ - ends_[1], end - before_last_,
            end - begin};
  }

 private:
  std::size_t asked_n_ = 0;
  std::array<AllocationCount, 2> ends_;
  AllocationCount before_last_, last_;
};

ByStage count_one(const BopImage& image, const PlanRequest& request,
                  const parts::Catalogue& catalogue, const perception::Parameters& parameters) {
  StageCounter counter;
  const perception::IsLate ask = counter.ask();
  const AllocationCount begin = allocations();
  const auto answer = perception::plan(image.frame, request, catalogue, parameters, ask);
  const AllocationCount end = allocations();
  if (!answer) throw std::runtime_error(answer.error().message);
  return counter.counts(begin, end);
}

/// One entry for each frame, of the last of several plans of it.
std::vector<ByStage> count_part(const parts::Catalogue& catalogue, const parts::Part& part,
                                const Options& options) {
  simulation::SceneOptions scene = pile_of(part, options.parts_per_frame_n);
  scene.seed = options.seed;
  const auto maker = simulation::SceneMaker::create(catalogue, scene);
  if (!maker) throw std::runtime_error(maker.error().message);
  const perception::Parameters parameters;
  std::vector<ByStage> counted;
  for (int k = 0; k < options.frames_n; ++k) {
    const auto image = maker->make(k);
    if (!image) throw std::runtime_error(image.error().message);
    const PlanRequest request = eval::request_for(*image, catalogue, {part.id});
    for (int warm = 0; warm < options.warm_up_n; ++warm) {
      count_one(*image, request, catalogue, parameters);
    }
    counted.push_back(count_one(*image, request, catalogue, parameters));
  }
  return counted;
}

double median(const std::vector<ByStage>& counted, std::size_t stage,
              std::int64_t AllocationCount::*what) {
  std::vector<double> values;
  values.reserve(counted.size());
  for (const ByStage& one : counted) values.push_back(static_cast<double>(one[stage].*what));
  return eval::quantile(values, 0.5);
}

void run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  Table raw({"part", "frame", "stage", "allocations", "bytes"});
  std::vector<ByStage> all;
  for (const parts::Part& part : catalogue->parts()) {
    const auto counted = count_part(*catalogue, part, options);
    for (std::size_t k = 0; k < counted.size(); ++k) {
      for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
        const AllocationCount& one = counted[k][stage];
        raw.add({part.id, std::to_string(k), kStages[stage], std::to_string(one.calls_n),
                 std::to_string(one.bytes)});
      }
    }
    all.insert(all.end(), counted.begin(), counted.end());
  }
  Table table({"stage", "allocations", "MB taken"});
  nlohmann::json figures;
  for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
    const double calls_n = median(all, stage, &AllocationCount::calls_n);
    const double megabytes = median(all, stage, &AllocationCount::bytes) * 1e-6;
    table.add({kStages[stage], fmt::format("{:.0f}", calls_n), fmt::format("{:.2f}", megabytes)});
    figures[fmt::format("{}.allocations", kStages[stage])] = calls_n;
    figures[fmt::format("{}.mb", kStages[stage])] = megabytes;
  }
  figures["allocations_per_frame"] = figures["all.allocations"];
  std::cout << table.to_markdown();
  std::ofstream(options.out / "allocations.csv") << raw.to_csv();
  std::ofstream(options.out / "allocations.json") << figures.dump(2) << "\n";
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_allocations", count, words, [&](CLI::App& app) {
    app.description("Heap allocations of a plan, stage by stage, after plans of the same frame.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--out", options.out, "folder for allocations.json and allocations.csv")
        ->capture_default_str();
    app.add_option("--frames", options.frames_n, "of each part")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--count", options.parts_per_frame_n, "parts in a frame")->capture_default_str();
    app.add_option("--seed", options.seed, "of the first frame")->capture_default_str();
    app.callback([&] { graspd::bench::run(options); });
  });
}
