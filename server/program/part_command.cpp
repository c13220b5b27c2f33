#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>

#include "commands.hpp"
#include "graspd/command_line/choices.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/parts/mesh_check.hpp"
#include "graspd/parts/part.hpp"
#include "refuse.hpp"

namespace graspd::program {
namespace {

struct CheckArguments {
  std::string file;
  std::string unit = "mm";
  parts::SensorResolution sensor;
};

/// Of a part file, or of a mesh alone.
Result<parts::PartDescription> description_of(const CheckArguments& arguments) {
  if (const std::filesystem::path file = arguments.file; file.extension() == ".yaml") {
    return parts::read_part_file(file);
  }
  parts::PartDescription description;
  description.id = std::filesystem::path(arguments.file).stem();
  description.mesh_file = arguments.file;
  description.mesh_unit = parse_enum<parts::LengthUnit>(arguments.unit).value();
  return description;
}

/// Without −0.
std::string in_digits(const Eigen::Vector3d& v, int digits) {
  const double scale = std::pow(10, digits);
  const Eigen::Array3d rounded = (v.array() * scale).round() / scale + 0.0;
  return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", rounded.x(), digits, rounded.y(), digits,
                     rounded.z(), digits);
}

/// One line for each point; images under the symmetries are counted.
Table pick_point_table(const parts::Part& part) {
  Table table({"pick point", "from", "gripper", "position_mm", "approach", "closing", "cone_deg",
               "width_mm", "priority", "images"});
  const auto& points = part.pick_points;
  for (auto first = points.begin(); first != points.end();) {
    const auto next = std::find_if(first, points.end(),
                                   [&](const auto& point) { return point.name != first->name; });
    table.add({first->name, first->is_proposed ? "mesh" : "part file",
               first->gripper.empty() ? "any" : first->gripper,
               in_digits(first->position_m * 1e3, 1), in_digits(first->approach, 2),
               in_digits(first->closing, 2),
               fmt::format("{:.0f}", first->approach_cone_rad * 180 / std::numbers::pi),
               fmt::format("{:.1f}", first->width_m * 1e3), fmt::format("{:.2f}", first->priority),
               std::to_string(next - first)});
    first = next;
  }
  return table;
}

bool is_error(const parts::MeshFinding& finding) {
  return finding.severity == parts::Severity::kError;
}

int check(const CheckArguments& arguments) {
  const auto description = description_of(arguments);
  if (!description) return refuse(description.error());
  const auto mesh = parts::load_mesh(description->mesh_file, description->mesh_unit);
  if (!mesh) return refuse(mesh.error());
  std::vector<parts::MeshFinding> findings =
      parts::check_mesh(*mesh, arguments.sensor, description->mesh_unit);
  std::optional<parts::Part> part;
  if (std::none_of(findings.begin(), findings.end(), is_error)) {
    if (auto made = parts::make_part(*description)) {
      part = std::move(*made);
    } else {
      findings.push_back({parts::Severity::kError, "pick points", made.error().message});
    }
  }
  Table table({"finding", "topic", "what"});
  for (const parts::MeshFinding& finding : findings) {
    table.add({std::string(name_of(finding.severity)), finding.topic, finding.sentence});
  }
  fmt::print("{}", table.to_text());
  if (!part) return kExitFailed;
  fmt::print("\n{}", pick_point_table(*part).to_text());
  return 0;
}

}  // namespace

void add_part_command(CLI::App& app) {
  CLI::App* part = app.add_subcommand("part", "work on parts of the catalogue");
  part->require_subcommand(1);
  set_help(*part, "", {"grasp_server part check deploy/parts/tee/part.yaml"});
  add_part_new_command(*part);
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = part->add_subcommand(
      "check", "say what is wrong with a mesh or a part, and where it can be grasped");
  command->add_option("FILE", arguments->file, "mesh (STL, PLY or OBJ), or a part.yaml")
      ->required();
  command->add_option("--unit", arguments->unit, "of a mesh")
      ->type_name("UNIT")
      ->check(one_of<parts::LengthUnit>())
      ->capture_default_str();
  command
      ->add_option("--distance-m", arguments->sensor.distance_m,
                   "from the camera to the parts, in metres")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  set_help(
      *command,
      "Exit codes: 0 usable (there may be warnings), 1 errors found, 2 the file can't be read.",
      {"grasp_server part check deploy/parts/tee/tee.stl --unit mm",
       "grasp_server part check deploy/parts/tee/part.yaml"});
  command->callback([arguments] {
    if (const int code = check(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::program
