/// The simulated Kinect v2 beside a real one: frame 0 of `kinect_tees`, a bin with four pipe tees
/// in a heap, and simulated frames of such a heap in such a bin.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/simulation/bin_mesh.hpp"
#include "graspd/simulation/kinect_v2.hpp"
#include "graspd/simulation/pile.hpp"
#include "sensor_comparison_measures.hpp"

namespace graspd::bench {
namespace {

// The bin as the real frame shows it: the rim's inner edge at 505 mm, the floor at 714 to 731 mm.
const Eigen::Vector3d kBinInnerSize_m(0.374, 0.268, 0.215);
constexpr double kWall_m = 0.02;
const Eigen::Vector3d kFloorNormal_camera(-0.049, -0.032, -0.998);
const Eigen::Vector3d kFloorCentre_camera_m(0.0333, 0.0797, 0.7245);
constexpr PixelBox kWithinRim{138, 164, 407, 354};
constexpr PixelBox kFloor{179, 182, 361, 313};

// Falling into a shaft makes a heap.
const Eigen::Vector3d kShaftSize_m(0.11, 0.10, 0.215);
constexpr int kTees = 4;

struct Options {
  std::filesystem::path data;
  std::filesystem::path json;
  std::filesystem::path csv;
  std::filesystem::path images;
  int frames_n = 8;
  std::uint64_t seed = 1;
};

std::filesystem::path default_data() {
  if (const char* data = std::getenv("GRASPD_REAL_DATA")) return data;
  return std::filesystem::path(GRASPD_SOURCE_DIR) / "../shared/data";
}

Eigen::Isometry3d pose_of_bin() {
  const Eigen::Vector3d z = kFloorNormal_camera.normalized();
  const Eigen::Vector3d x = (Eigen::Vector3d::UnitX() - z * z.x()).normalized();
  Eigen::Isometry3d T_camera_bin = Eigen::Isometry3d::Identity();
  T_camera_bin.linear() << x, z.cross(x), z;
  T_camera_bin.translation() = kFloorCentre_camera_m;
  return T_camera_bin;
}

Result<DepthFrame> simulate(const simulation::PileMaker& piles, const parts::Mesh& tee,
                            const CameraIntrinsics& camera, std::uint64_t seed) {
  const auto pile = piles.drop({kTees}, kShaftSize_m, seed);
  if (!pile) return tl::unexpected(pile.error());
  const Eigen::Isometry3d T_camera_bin = pose_of_bin();
  const parts::Mesh bin = simulation::bin_mesh(kBinInnerSize_m, kWall_m);
  std::vector<simulation::SceneObject> scene{{&bin, T_camera_bin}};
  for (const auto& part : pile->parts) scene.push_back({&tee, T_camera_bin * part.T_bin_part});
  simulation::KinectV2Parameters sensor;
  sensor.camera = camera;
  const simulation::Walls walls{T_camera_bin, kBinInnerSize_m};
  return observe(scene, sensor, seed, &walls);
}

struct Row {
  const char* name;
  const char* unit;
  double SensorMeasures::*value;
  double scale;
  int digits;
};
constexpr Row kRows[] = {
    {"empty pixels within the rim", "%", &SensorMeasures::empty_share, 100, 2},
    {"plane noise, 1 sigma", "mm", &SensorMeasures::plane_noise_mm, 1, 2},
    {"noise correlation of neighbours", "", &SensorMeasures::noise_correlation, 1, 2},
    {"floor's rise near the walls", "mm", &SensorMeasures::floor_bend_mm, 1, 1},
    {"edge width, 10-90 %", "px", &SensorMeasures::edge_width_px, 1, 2},
    {"edge roughness, 1 sigma", "px", &SensorMeasures::edge_roughness_px, 1, 2},
    {"flying pixels, of those on parts", "%", &SensorMeasures::flying_share, 100, 1},
    {"mean slope on parts", "mm/px", &SensorMeasures::slope_on_parts, 1, 2},
};

struct Summary {
  double mean = 0;
  double low = 0;
  double high = 0;
};

Summary summarise(const std::vector<SensorMeasures>& frames, const Row& row) {
  Summary summary{0, std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const SensorMeasures& frame : frames) {
    const double value = frame.*row.value * row.scale;
    summary.mean += value / double(frames.size());
    summary.low = std::min(summary.low, value);
    summary.high = std::max(summary.high, value);
  }
  return summary;
}

Result<void> run(const Options& options) {
  const auto scene = BopScene::open(options.data / "kinect_tees" / "scene");
  if (!scene) return tl::unexpected(scene.error());
  const auto real = scene->read(0);
  if (!real) return tl::unexpected(real.error());
  const auto tee = parts::load_mesh(options.data / "kinect_tees" / "models" / "tee.stl",
                                    parts::LengthUnit::kMillimetre);
  if (!tee) return tl::unexpected(tee.error());

  const simulation::PileMaker piles({*tee});
  std::vector<SensorMeasures> simulated;
  for (int k = 0; k < options.frames_n; ++k) {
    const auto frame = simulate(piles, *tee, real->frame.camera, options.seed + std::uint64_t(k));
    if (!frame) return tl::unexpected(frame.error());
    simulated.push_back(measure(*frame, kWithinRim, kFloor));
    if (!options.images.empty()) {
      const Image16 image{frame->camera.width_px, frame->camera.height_px, frame->depth};
      auto ok = write_png16(options.images / fmt::format("simulated_{}.png", k), image);
      if (!ok) return ok;
    }
  }
  const SensorMeasures measured = measure(real->frame, kWithinRim, kFloor);

  Table table({"measure", "unit", "real frame", "simulated", "lowest", "highest"});
  nlohmann::json json;
  for (const Row& row : kRows) {
    const Summary summary = summarise(simulated, row);
    const auto number = [&](double value) { return fmt::format("{:.{}f}", value, row.digits); };
    table.add({row.name, row.unit, number(measured.*row.value * row.scale), number(summary.mean),
               number(summary.low), number(summary.high)});
    const std::string unit = *row.unit == '\0' ? "" : fmt::format(" ({})", row.unit);
    json[fmt::format("real: {}{}", row.name, unit)] = measured.*row.value * row.scale;
    json[fmt::format("simulated: {}{}", row.name, unit)] = summary.mean;
  }
  fmt::print("{}", table.to_text());
  if (!options.json.empty()) std::ofstream(options.json) << json.dump(2) << "\n";
  if (!options.csv.empty()) std::ofstream(options.csv) << table.to_csv();
  return {};
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  options.data = graspd::bench::default_data();
  return graspd::run_program("bench_sensor_comparison", count, words, [&](CLI::App& app) {
    app.description("Compares simulated Kinect v2 frames with a real one.");
    app.add_option("--data", options.data, "folder with kinect_tees")->capture_default_str();
    app.add_option("--json", options.json, "write the numbers here");
    app.add_option("--csv", options.csv, "write the table here");
    app.add_option("--images", options.images, "write the simulated depth images into this folder");
    app.add_option("--frames", options.frames_n, "simulated frames")->check(CLI::PositiveNumber);
    app.add_option("--seed", options.seed, "of the first simulated frame");
    app.callback([&] {
      if (auto ok = graspd::bench::run(options); !ok) throw std::runtime_error(ok.error().message);
    });
  });
}
