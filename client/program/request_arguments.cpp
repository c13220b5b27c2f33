#include "request_arguments.hpp"

#include "graspd/formats/cell.hpp"

namespace graspd::program {

std::vector<CLI::Option*> add_request_options(CLI::App& command, RequestArguments& arguments) {
  CLI::Option* camera =
      command.add_option("--camera", arguments.camera, "OpenCV calibration (and T_base_camera)");
  CLI::Option* part =
      command.add_option("--part", arguments.parts, "part to look for; say it once per part");
  command.add_option("--cell", arguments.cell, "bin and gripper of the cell")->type_name("YAML");
  return {camera->type_name("YAML"), part->type_name("ID")};
}

Result<CellRequest> read_cell_request(const RequestArguments& arguments) {
  const auto calibration = read_camera(arguments.camera);
  if (!calibration) return tl::unexpected(calibration.error());
  CellRequest asked{calibration->camera, calibration->depth_scale_m, {}};
  asked.request.T_base_camera = calibration->T_base_camera.value_or(looking_down());
  if (!arguments.cell.empty()) {
    const auto cell = read_cell(arguments.cell);
    if (!cell) return tl::unexpected(cell.error());
    asked.request.bin = cell->bin;
    asked.request.gripper = cell->gripper;
  }
  for (const std::string& part : arguments.parts) asked.request.parts.push_back({part, 0});
  return asked;
}

}  // namespace graspd::program
