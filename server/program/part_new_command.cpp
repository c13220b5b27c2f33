#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "graspd/command_line/choices.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/onboarding/decimate.hpp"
#include "graspd/onboarding/part_folder.hpp"
#include "graspd/onboarding/report.hpp"
#include "graspd/service/build_id.hpp"
#include "refuse.hpp"

namespace graspd::program {
namespace {

struct NewArguments {
  std::filesystem::path mesh, parts, camera, cell, report;
  std::string name;
  std::string unit = "mm";
  std::vector<double> bin_size_m;
  bool is_replacing = false;
  onboarding::ForecastOptions forecast;
};

/// One line for each step, as it ends.
template <class... Args>
void say(std::string_view step, fmt::format_string<Args...> format, Args&&... args) {
  fmt::print("{:<12} {}\n", step, fmt::format(format, std::forward<Args>(args)...));
  std::fflush(stdout);
}

/// A bar for each step of the forecast.
class StepBars {
 public:
  void operator()(std::string_view step, int, int of_n) {
    if (step != step_) bar_.emplace(std::string(step), static_cast<std::size_t>(of_n));
    step_ = step;
    bar_->step();
  }

 private:
  std::string step_;
  std::optional<Progress> bar_;
};

/// The cell's files into the forecast's options.
Result<onboarding::ForecastOptions> options_of(const NewArguments& arguments) {
  onboarding::ForecastOptions options = arguments.forecast;
  if (!arguments.cell.empty()) {
    const auto cell = read_cell(arguments.cell);
    if (!cell) return tl::unexpected(cell.error());
    options.gripper = cell->gripper;
    if (cell->bin) options.scene.bin_inner_size_m = cell->bin->inner_size_m;
    if (cell->gripper.kind == GripperKind::kSuction) {
      return invalid("{}: suction is not in this version; give a gripper with parallel jaws",
                     arguments.cell.string());
    }
  }
  if (!arguments.bin_size_m.empty()) {
    options.scene.bin_inner_size_m = Eigen::Map<const Eigen::Vector3d>(arguments.bin_size_m.data());
  }
  if (!arguments.camera.empty()) {
    const auto calibration = read_camera(arguments.camera);
    if (!calibration) return tl::unexpected(calibration.error());
    options.scene.sensor.camera = calibration->camera;
  }
  return options;
}

parts::SensorResolution resolution_of(const simulation::SceneOptions& scene) {
  return {scene.sensor.camera.fx_px, scene.camera_height_m};
}

/// Fewer triangles where there are too many, and what is to be said of that and of the mesh.
struct CheckedMesh {
  parts::Mesh mesh;
  std::vector<parts::MeshFinding> findings;

  bool is_usable() const {
    return std::ranges::none_of(findings, [](const parts::MeshFinding& finding) {
      return finding.severity == parts::Severity::kError;
    });
  }
};

Result<CheckedMesh> checked_mesh(const NewArguments& arguments,
                                 const parts::SensorResolution& sensor) {
  const auto unit = *parse_enum<parts::LengthUnit>(arguments.unit);
  auto mesh = parts::load_mesh(arguments.mesh, unit);
  if (!mesh) return tl::unexpected(mesh.error());
  CheckedMesh checked;
  if (const std::size_t before_n = mesh->triangles.size(); before_n > onboarding::kMaxTriangles) {
    auto decimated = onboarding::decimate(*mesh);
    *mesh = std::move(decimated.mesh);
    checked.findings.push_back(
        {parts::Severity::kOk, "decimated",
         fmt::format("{} triangles are more than a camera can see: reduced to {}, which moves the "
                     "surface by {:.2g} mm at most. What is said of edges may come of "
                     "that.",
                     before_n, mesh->triangles.size(), decimated.error_m * 1e3)});
  }
  std::ranges::move(parts::check_mesh(*mesh, sensor, unit), std::back_inserter(checked.findings));
  checked.mesh = *std::move(mesh);
  return checked;
}

void say_findings(const std::vector<parts::MeshFinding>& findings) {
  for (const parts::MeshFinding& finding : findings) {
    const bool is_fault = finding.severity != parts::Severity::kOk;
    const bool is_said = is_fault || finding.topic == "units" || finding.topic == "decimated" ||
                         finding.topic == "symmetries" || finding.topic == "size";
    if (!is_said) continue;
    say(finding.topic, "{}{}", is_fault ? fmt::format("{}: ", name_of(finding.severity)) : "",
        finding.sentence);
  }
}

void say_poses(const onboarding::Onboarding& onboarding) {
  const auto groups = onboarding::alike(onboarding.poses, onboarding.part);
  double most = 0;
  for (const std::size_t pose : groups.front()) most += onboarding.poses[pose].probability;
  say("rests", "{} stable pose{} of {} kind{}; the most probable kind has {:.0f} %",
      onboarding.poses.size(), onboarding.poses.size() == 1 ? "" : "s", groups.size(),
      groups.size() == 1 ? "" : "s", 100 * most);
}

void say_pick_points(const onboarding::Onboarding& onboarding) {
  const auto points = onboarding::jaw_points_of(onboarding.part);
  const Gripper& gripper = onboarding.options.gripper;
  const auto fitting_n = std::ranges::count_if(points, [&](const parts::PickPoint& point) {
    return onboarding::opening_for(point, gripper) <= gripper.max_opening_m;
  });
  say("pick points", "{} for jaws, {} of them within the gripper's {:.0f} mm", points.size(),
      fitting_n, gripper.max_opening_m * 1e3);
}

/// What was typed, with what was not.
std::vector<std::string> commands_of(const NewArguments& arguments,
                                     const onboarding::ForecastOptions& options, int parts_n) {
  const auto& scene = options.scene;
  const Eigen::Vector3d& bin_m = scene.bin_inner_size_m;
  const auto optional = [](std::string_view flag, const std::filesystem::path& file) {
    return file.empty() ? std::string() : fmt::format(" {} {}", flag, file.string());
  };
  const std::string camera = optional("--camera", arguments.camera);
  const std::string folder = arguments.parts.string();
  const std::string piles = "build/" + arguments.name + "_piles";
  return {
      fmt::format("grasp_server part new {} --name {} --unit {} --out {}{}{} --bin-size-m {} {} {} "
                  "--distance-m {} --piles {} --seed {}",
                  arguments.mesh.string(), arguments.name, arguments.unit, folder, camera,
                  optional("--cell", arguments.cell), bin_m.x(), bin_m.y(), bin_m.z(),
                  scene.camera_height_m, options.piles_n, scene.seed),
      fmt::format(
          "robot_agent simulate --parts {} --part {}={} --frames {} --seed {}{} --bin-size-m "
          "{} {} {} --camera-height-m {} --out {}",
          folder, arguments.name, parts_n, options.piles_n, scene.seed, camera, bin_m.x(),
          bin_m.y(), bin_m.z(), scene.camera_height_m, piles),
      fmt::format("grasp_server eval {} --parts {} --out {}.csv", piles, folder, piles)};
}

Result<void> write_report(const std::filesystem::path& path,
                          const onboarding::Onboarding& onboarding) {
  std::ofstream file(path);
  file << onboarding::html_report(onboarding) << std::flush;
  if (!file) return invalid("--report {}: can't be written; is its folder there?", path.string());
  return {};
}

void say_figures(const onboarding::Onboarding& onboarding) {
  Table table({"forecast", "figure", "95 %", "of"});
  for (const onboarding::Figure& figure : onboarding::figures_of(onboarding)) {
    table.add(
        {figure.what, figure.value, figure.interval.empty() ? "–" : figure.interval, figure.of});
  }
  fmt::print("\n{}\n{}\n", table.to_text(), onboarding::verdict_of(onboarding).sentence);
  for (const std::string& sentence : onboarding::advice_for(onboarding))
    fmt::print("- {}\n", sentence);
}

std::string remarks_of(const onboarding::Onboarding& onboarding) {
  return fmt::format(
      "Made by `grasp_server part new` from {}. {}\ndeploy/parts/README.md in graspd documents "
      "every key.",
      onboarding.mesh_name, onboarding::verdict_of(onboarding).sentence);
}

int make_new(const NewArguments& arguments) {
  const auto options = options_of(arguments);
  if (!options) return refuse(options.error());
  const auto checked = checked_mesh(arguments, resolution_of(options->scene));
  if (!checked) return refuse(checked.error());
  say_findings(checked->findings);
  if (!checked->is_usable()) return kExitFailed;
  const auto version = onboarding::version_in(arguments.parts, arguments.name, checked->mesh,
                                              arguments.is_replacing);
  if (!version) return refuse(version.error());
  const auto give_up = [&](const Error& error) {
    onboarding::discard_mesh(*version);
    return refuse(error);
  };
  auto part = onboarding::write_mesh(*version, checked->mesh);
  if (!part) return give_up(part.error());

  onboarding::Onboarding found;
  found.mesh_name = arguments.mesh.filename();
  found.version = version->version;
  found.findings = checked->findings;
  found.part = *std::move(part);
  found.options = *options;
  found.build = service::build_id();
  found.poses = onboarding::stable_poses(found.part);
  say_poses(found);
  say_pick_points(found);
  auto forecast = [&] {
    StepBars bars;
    return onboarding::forecast(found.part, *options, std::ref(bars));
  }();
  if (!forecast) return give_up(forecast.error());
  found.forecast = *std::move(forecast);
  found.commands = commands_of(arguments, *options, found.forecast.piles.front().parts_n);
  say("forecast", "{} pile{} of {} parts in {:.0f} s", found.forecast.piles.size(),
      found.forecast.piles.size() == 1 ? "" : "s", found.forecast.piles.front().parts_n,
      found.forecast.duration_s);

  if (auto ok = onboarding::write_part_file(*version, remarks_of(found)); !ok) {
    return refuse(ok.error());
  }
  say("part", "{}: version {}{}", version->part_file().string(), version->version,
      version->is_there_already
          ? ", as it was; nothing is written"
          : "; a server on this folder loads it when it starts, or at SIGHUP");
  const auto report = arguments.report.empty() ? version->folder / "report.html" : arguments.report;
  if (auto ok = write_report(report, found); !ok) return refuse(ok.error());
  say("report", "{}", report.string());
  say_figures(found);
  return kExitDone;
}

}  // namespace

void add_part_new_command(CLI::App& part) {
  const auto arguments = std::make_shared<NewArguments>();
  CLI::App* command = part.add_subcommand(
      "new", "make a part of a mesh, and forecast how well a cell will pick it");
  command->add_option("MESH", arguments->mesh, "STL, PLY or OBJ")->required();
  command->add_option("--name", arguments->name, "what requests call the part")->required();
  command->add_option("--out", arguments->parts, "folder of parts, to which it is added")
      ->required()
      ->type_name("DIR");
  command->add_option("--unit", arguments->unit, "of the mesh: " + names_of<parts::LengthUnit>())
      ->check(one_of<parts::LengthUnit>())
      ->capture_default_str();
  command->add_option("--cell", arguments->cell, "bin and gripper of the cell")->type_name("YAML");
  command->add_option("--bin-size-m", arguments->bin_size_m, "inner sizes: longer, shorter, height")
      ->expected(3)
      ->check(CLI::Range(0.02, 3.0))
      ->type_name("X Y Z");
  onboarding::ForecastOptions& forecast = arguments->forecast;
  command
      ->add_option("--distance-m", forecast.scene.camera_height_m,
                   "from the camera to the bin's floor")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->add_option("--camera", arguments->camera, "intrinsics from an OpenCV calibration file")
      ->type_name("YAML");
  command->add_option("--piles", forecast.piles_n, "simulated for the forecast")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--limit-s", forecast.limit_s, "no pile is begun after so long")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--seed", forecast.scene.seed, "of the first pile; the next ones count up")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--report", arguments->report,
                   "where the report goes (default: beside part.yaml)")
      ->type_name("HTML");
  command->add_flag("--replace", arguments->is_replacing,
                    "put this mesh in the place of a part of that name, as its next version");
  set_help(*command,
           "Exit codes: 0 made, 1 the mesh can't be a part or the forecast failed, 2 wrong command "
           "line or file",
           {"grasp_server part new deploy/parts/tee/tee.stl --name my_tee --out build/my_parts "
            "--piles 1"});
  command->callback([arguments] {
    if (const int code = make_new(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::program
