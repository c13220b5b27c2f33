#include <spdlog/spdlog.h>

#include <charconv>
#include <cstdio>
#include <fstream>

#include "commands.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/installed.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/sim_cell/scene_folder.hpp"
#include "graspd/types/mean_frame.hpp"

namespace graspd::robot_agent {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::vector<std::string> parts;
  fs::path catalogue;
  fs::path camera;
  fs::path output;
  std::vector<double> bin_size_m;
  simulation::SceneOptions scene;
};

/// "tee=45"
Result<simulation::PartCount> parse_part(const std::string& text) {
  const auto equals = text.find('=');
  simulation::PartCount part{text.substr(0, equals), 0};
  const char* const end = text.data() + text.size();
  const char* const number = equals == std::string::npos ? end : text.data() + equals + 1;
  const auto [last, error] = std::from_chars(number, end, part.count_n);
  if (error != std::errc() || last != end || part.part_id.empty() || part.count_n < 1) {
    return invalid("--part {}: say which part and how many, as in tee=45", text);
  }
  return part;
}

Result<simulation::SceneOptions> scene_options(const SimulateArguments& arguments) {
  simulation::SceneOptions scene = arguments.scene;
  for (const std::string& text : arguments.parts) {
    auto part = parse_part(text);
    if (!part) return tl::unexpected(part.error());
    scene.parts.push_back(*std::move(part));
  }
  if (!arguments.bin_size_m.empty()) {
    scene.bin_inner_size_m = Eigen::Map<const Eigen::Vector3d>(arguments.bin_size_m.data());
  }
  if (!arguments.camera.empty()) {
    const auto calibration = read_camera(arguments.camera);
    if (!calibration) return tl::unexpected(calibration.error());
    scene.sensor.camera = calibration->camera;
  }
  return scene;
}

std::string pose_numbers(const Eigen::Isometry3d& T) {
  const Eigen::IOFormat rows(Eigen::FullPrecision, Eigen::DontAlignCols, ", ", ", ", "", "", "[",
                             "]");
  std::ostringstream text;
  text << T.matrix().format(rows);
  return text.str();
}

Result<void> write_file(const fs::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) return invalid("{}: can't be written; is the disk full?", path.string());
  return {};
}

/// The scene's camera and bin as the files that `grasp plan` takes.
Result<void> write_cell_files(const fs::path& directory) {
  const auto scene = BopScene::open(directory);
  if (!scene) return tl::unexpected(scene.error());
  const auto image = scene->read(scene->image_ids().front());
  if (!image) return tl::unexpected(image.error());
  const Eigen::Isometry3d T_base_camera = image->T_world_camera.value_or(looking_down());
  const CameraCalibration calibration{image->frame.camera, image->frame.depth_scale_m,
                                      T_base_camera, std::nullopt};
  if (auto ok = write_camera(directory / "camera.yaml", calibration); !ok) return ok;
  if (!image->bin) return {};
  const Eigen::Vector3d& size_m = image->bin->inner_size_m;
  return write_file(directory / "cell.yaml",
                    fmt::format("bin:\n  T_base_bin: {}\n  inner_size_m: [{}, {}, {}]\n",
                                pose_numbers(T_base_camera * image->bin->T_camera_bin), size_m.x(),
                                size_m.y(), size_m.z()));
}

Result<sim_cell::SceneReport> simulate_into(const SimulateArguments& arguments) {
  const auto scene = scene_options(arguments);
  if (!scene) return tl::unexpected(scene.error());
  const auto catalogue = parts::Catalogue::load(arguments.catalogue);
  if (!catalogue) return tl::unexpected(catalogue.error());
  Progress progress("simulating", static_cast<std::size_t>(scene->frames_n));
  auto report =
      sim_cell::simulate_scene(*catalogue, *scene, arguments.output, [&](int) { progress.step(); });
  if (!report) return report;
  if (auto ok = write_cell_files(arguments.output); !ok) return tl::unexpected(ok.error());
  return report;
}

int simulate(const SimulateArguments& arguments) {
  const auto report = simulate_into(arguments);
  if (!report) {
    spdlog::error("{}", report.error().message);
    return report.error().code == Code::kInternal ? kExitFailed : kExitWrongInput;
  }
  fmt::print("{}: {} frame{}, {} parts, {:.0f} % of them visible by half or more\n",
             arguments.output.string(), report->frames_n, report->frames_n == 1 ? "" : "s",
             report->parts_n, 100 * report->visible_share);
  return kExitDone;
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  const auto arguments = std::make_shared<SimulateArguments>();
  arguments->catalogue = installed("usr/share/graspd/parts");
  if (arguments->catalogue.empty()) arguments->catalogue = "deploy/parts";
  simulation::SceneOptions& scene = arguments->scene;
  CLI::App* command =
      app.add_subcommand("simulate", "record piles of parts under a simulated Kinect v2");
  command->add_option("--part", arguments->parts, "drop so many of this part; may be repeated")
      ->required()
      ->type_name("ID=N");
  command->add_option("--out", arguments->output, "folder of the scene")
      ->required()
      ->type_name("DIR");
  command->add_option("--frames", scene.frames_n, "piles, each with one frame")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", scene.seed, "of the first pile; the next ones count up")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--parts", arguments->catalogue, "folder of the part catalogue")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--camera", arguments->camera, "intrinsics from an OpenCV calibration file")
      ->type_name("FILE");
  command->add_option("--camera-height-m", scene.camera_height_m, "above the bin's floor")
      ->capture_default_str();
  command->add_option("--camera-tilt-rad", scene.camera_tilt_rad, "about the bin's longer side")
      ->capture_default_str();
  command->add_option("--looks", scene.looks_n, "frame: the mean of so many looks at the pile")
      ->type_name("N")
      ->check(CLI::Range(1, static_cast<int>(kMaxMeanFrames)))
      ->capture_default_str();
  command->add_option("--bin-size-m", arguments->bin_size_m, "inner sizes: longer, shorter, height")
      ->expected(3)
      ->type_name("X Y Z");
  set_help(*command,
           "Writes a BOP scene (depth, poses, visible fractions, instance ids), the same frames as "
           "an MRPT rawlog, frames.rawlog, and camera.yaml and cell.yaml for 'grasp plan'. The "
           "same seed makes the same frames.",
           {"robot_agent simulate --part tee=12 --part elbow=6 --frames 2 --out build/piles"});
  command->callback([arguments] {
    if (const int code = simulate(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::robot_agent
