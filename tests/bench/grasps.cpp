/// Whether the planner's grasps would work: planned on simulated Kinect v2 frames, judged from the
/// true poses and meshes by code that knows nothing of planning.
///
/// Pile k has the seed `seed + k`; any 108 piles in a row show each part in each number and from
/// each camera pose once. Tuning seeds start at 1000.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iostream>

#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "grasps_report.hpp"
#include "grasps_runs.hpp"

namespace graspd::bench {
namespace {

constexpr int kFirstTuningSeed = 1000;
constexpr double kDegree_rad = M_PI / 180;

constexpr std::array kPartsInPile{15, 30, 45};
constexpr std::array kCameraHeights_m{0.7, 0.8, 0.9};
constexpr std::array kCameraTilts_rad{0.0, 15 * kDegree_rad};

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::string out = "build/bench/grasps";
  int piles_n = 200;
  int seed = 1;
  perception::Parameters parameters;
};

Pile pile_of(int k, const parts::Catalogue& catalogue, const Options& options) {
  // Digits of a number in mixed base: each combination once, the part changing fastest.
  auto rest = static_cast<std::size_t>(k);
  const auto digit = [&rest](const auto& values) -> const auto& {
    const auto& value = values[rest % values.size()];
    rest /= values.size();
    return value;
  };
  Pile pile;
  pile.part = &digit(catalogue.parts());
  pile.scene.parts = {{pile.part->id, digit(kPartsInPile)}};
  pile.scene.camera_height_m = digit(kCameraHeights_m);
  pile.scene.camera_tilt_rad = digit(kCameraTilts_rad);
  pile.scene.seed = static_cast<std::uint64_t>(options.seed + k);
  return pile;
}

Result<void> write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) return invalid("{}: can't be written; is its folder there?", path);
  return {};
}

Result<void> run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  if (options.seed < kFirstTuningSeed && options.seed + options.piles_n > kFirstTuningSeed) {
    return invalid("--seed {} with {} piles: test seeds are 1 to {}, tuning seeds the others",
                   options.seed, options.piles_n, kFirstTuningSeed - 1);
  }
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<JudgedPile> piles;
  Progress progress("piles", static_cast<std::size_t>(options.piles_n));
  for (int k = 0; k < options.piles_n; ++k) {
    auto judged = judge_pile(pile_of(k, *catalogue, options), *catalogue, options.parameters);
    if (!judged) return fail(judged.error().code, "pile {}: {}", k, judged.error().message);
    piles.push_back(*std::move(judged));
    progress.step();
  }
  progress.hide();
  std::cout << grasps_table(piles).to_markdown() << "\n" << causes_table(piles).to_markdown();
  const auto write = [&](const char* ending, const std::string& text) {
    return write_file(options.out + ending, text);
  };
  return write(".csv", grasp_records(piles).to_csv())
      .and_then([&] { return write(".json", grasps_figures(piles).dump(2) + "\n"); })
      .and_then([&] { return write("_plots.json", grasps_plot(piles).dump() + "\n"); });
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_grasps", count, words, [&](CLI::App& app) {
    app.description("Planned grasps judged from the true poses of simulated Kinect v2 piles.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--piles", options.piles_n, "how many")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seed", options.seed, "of the first; from 1000 on for tuning")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--confidence", options.parameters.grs.confidence,
                   "power of the registration's score in GRS")
        ->capture_default_str();
    app.add_option("--out", options.out, "stem of the files that are written")
        ->capture_default_str();
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
