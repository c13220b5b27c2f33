#include "perception_growth.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "graspd/command_line/progress.hpp"
#include "graspd/eval/evaluate.hpp"
#include "graspd/eval/quantile.hpp"
#include "piles.hpp"
#include "slope.hpp"

namespace graspd::bench {
namespace {

constexpr std::array kNumbers{5, 10, 20, 30, 45, 60, 80, 100};
constexpr double kHalfVisible = 0.5;

/// With room for a hundred tees.
const Eigen::Vector3d kBinInnerSize_m(0.42, 0.34, 0.16);

Result<GrowthRun> measure_one(const BopImage& image, int asked_n, const parts::Catalogue& catalogue,
                              const std::string& part_id,
                              const perception::Parameters& parameters) {
  const PlanRequest request = eval::request_for(image, catalogue, {part_id});
  const auto report = eval::evaluate_image(image, 0, request, catalogue, parameters);
  if (!report) return tl::unexpected(report.error());
  GrowthRun run;
  run.asked_n = asked_n;
  run.parts_n = static_cast<int>(image.truth.size());
  run.visible_n =
      static_cast<int>(std::count_if(image.truth.begin(), image.truth.end(), [](const auto& part) {
        return part.visible_fraction >= kHalfVisible;
      }));
  run.answers_n = static_cast<int>(report->answer.objects.size());
  run.points_n = static_cast<int>(report->answer.funnel.after_plane_n);
  run.time_ms = report->cpu_time_s * 1e3;
  return run;
}

}  // namespace

Result<std::vector<GrowthRun>> measure_growth(const parts::Catalogue& catalogue,
                                              const GrowthOptions& options) {
  const parts::Part* const part = catalogue.find(options.part_id);
  if (part == nullptr) return invalid("no part '{}' in the catalogue", options.part_id);
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<GrowthRun> runs;
  for (const int asked_n : kNumbers) {
    simulation::SceneOptions scene = pile_of(*part, asked_n);
    scene.bin_inner_size_m = kBinInnerSize_m;
    scene.seed = options.seed;
    const auto maker = simulation::SceneMaker::create(catalogue, scene);
    if (!maker) return tl::unexpected(maker.error());
    Progress progress(fmt::format("{} parts", asked_n), static_cast<std::size_t>(options.frames_n));
    for (int k = 0; k < options.frames_n; ++k) {
      auto image = maker->make(k);
      if (!image) return tl::unexpected(image.error());
      image->instance.reset();
      const auto run = measure_one(*image, asked_n, catalogue, part->id, {});
      if (!run) return tl::unexpected(run.error());
      runs.push_back(*run);
      progress.step();
    }
  }
  return runs;
}

std::vector<int> asked_numbers(const std::vector<GrowthRun>& runs) {
  std::vector<int> numbers;
  for (const GrowthRun& run : runs) {
    if (numbers.empty() || numbers.back() != run.asked_n) numbers.push_back(run.asked_n);
  }
  return numbers;
}

GrowthRun median_of(const std::vector<GrowthRun>& runs, int asked_n) {
  const auto median = [&](auto GrowthRun::*what) {
    std::vector<double> values;
    for (const GrowthRun& run : runs) {
      if (run.asked_n == asked_n) values.push_back(run.*what);
    }
    return eval::quantile(values, 0.5);
  };
  const auto whole = [&](int GrowthRun::*what) {
    return static_cast<int>(std::lround(median(what)));
  };
  return {asked_n,
          whole(&GrowthRun::parts_n),
          whole(&GrowthRun::visible_n),
          whole(&GrowthRun::answers_n),
          whole(&GrowthRun::points_n),
          median(&GrowthRun::time_ms)};
}

double growth_exponent(const std::vector<GrowthRun>& runs) {
  std::vector<Eigen::Vector2d> logs;
  for (const int asked_n : asked_numbers(runs)) {
    const GrowthRun median = median_of(runs, asked_n);
    logs.emplace_back(std::log(median.parts_n), std::log(median.time_ms));
  }
  return slope(logs);
}

}  // namespace graspd::bench
