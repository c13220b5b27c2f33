/// graspd's perception and that of the open libraries on the same simulated Kinect v2 frames: time,
/// recall and precision, from clusters and from poses; and how the time grows with the parts.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "graspd/command_line/run_program.hpp"
#include "perception_report.hpp"

namespace graspd::bench {
namespace {

struct Options {
  std::filesystem::path parts = "deploy/parts";
  std::filesystem::path out = "build/bench";
  PerceptionOptions measured;
  GrowthOptions growth;
};

Result<void> run(const Options& options) {
  const auto catalogue = parts::Catalogue::load(options.parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto growth = measure_growth(*catalogue, options.growth);
  if (!growth) return tl::unexpected(growth.error());
  const auto runs = measure(*catalogue, options.measured);
  if (!runs) return tl::unexpected(runs.error());
  std::cout << method_table(*runs).to_markdown() << "\n" << growth_table(*growth).to_markdown();
  std::ofstream(options.out / "perception.csv") << raw_table(*runs).to_csv();
  std::ofstream(options.out / "perception_growth.csv") << raw_growth_table(*growth).to_csv();
  std::ofstream(options.out / "perception.json")
      << figures_of(*runs, *growth, *catalogue).dump(2) << "\n";
  return {};
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_perception", count, words, [&](CLI::App& app) {
    app.description(
        "graspd's perception beside PCL's, OpenCV's and Open3D's, on simulated frames.");
    app.add_option("--parts", options.parts, "part catalogue")->capture_default_str();
    app.add_option("--out", options.out, "folder for perception.json and the CSV files")
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
    app.add_option("--growth-frames", options.growth.frames_n, "of each number of parts")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
