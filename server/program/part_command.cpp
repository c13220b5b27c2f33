#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/parts/mesh_check.hpp"

namespace graspd::program {
namespace {

struct CheckArguments {
  std::string mesh;
  std::string unit = "mm";
  parts::SensorResolution sensor;
};

int check(const CheckArguments& arguments) {
  const auto unit = parse_enum<parts::LengthUnit>(arguments.unit).value();
  const auto mesh = parts::load_mesh(arguments.mesh, unit);
  if (!mesh) {
    fmt::print(stderr, "grasp_server: {}: {}\n", name_of(mesh.error().code), mesh.error().message);
    return kExitWrongInput;
  }
  const std::vector<parts::MeshFinding> findings = parts::check_mesh(*mesh, arguments.sensor);
  Table table({"finding", "topic", "what"});
  for (const parts::MeshFinding& finding : findings) {
    table.add({std::string(name_of(finding.severity)), finding.topic, finding.sentence});
  }
  fmt::print("{}", table.to_text());
  const bool wrong = std::any_of(findings.begin(), findings.end(), [](const auto& finding) {
    return finding.severity == parts::Severity::kError;
  });
  return wrong ? kExitFailed : 0;
}

}  // namespace

void add_part_command(CLI::App& app) {
  CLI::App* part = app.add_subcommand("part", "work on parts of the catalogue");
  part->require_subcommand(1);
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = part->add_subcommand("check", "say what is wrong with a mesh");
  command->add_option("MESH", arguments->mesh, "STL, PLY or OBJ file")->required();
  command->add_option("--unit", arguments->unit, "of the file: " + names_of<parts::LengthUnit>())
      ->check([](const std::string& name) {
        return parse_enum<parts::LengthUnit>(name) ? "" : "known: " + names_of<parts::LengthUnit>();
      })
      ->capture_default_str();
  command
      ->add_option("--distance-m", arguments->sensor.distance_m,
                   "from the camera to the parts, in metres")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->footer(
      "Exit codes: 0 usable (there may be warnings), 1 errors found, 2 the file can't be read\n\n"
      "Example: grasp_server part check deploy/parts/tee/tee.stl --unit mm");
  command->callback([arguments] {
    if (const int code = check(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::program
