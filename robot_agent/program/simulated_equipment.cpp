#include "simulated_equipment.hpp"

#include "graspd/motion/planned_arm.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/simulated/film.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::robot_agent {
namespace {

/// What a simulated cell is made of; all of it lives as long as any of its ports.
struct Simulated {
  std::vector<parts::Mesh> kinds;
  std::optional<agent::SimCell> cell;
  std::unique_ptr<agent::Arm> arm;
  std::optional<agent::Film> film;
};

/// The parts that may be in the bin.
struct Kinds {
  std::vector<parts::Mesh> meshes;
  std::vector<sim_cell::Rgb> colors;
};

Result<Kinds> kinds_of(const CellConfig& config) {
  const auto catalogue = parts::Catalogue::load(config.pile->parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  Kinds kinds;
  for (const RequestedPart& requested : config.parts) {
    const parts::Part* part = catalogue->find(requested.id);
    if (part == nullptr) {
      return fail(Code::kUnknownPart, "parts: {} has no part '{}'", config.pile->parts.string(),
                  requested.id);
    }
    kinds.meshes.push_back(part->mesh);
    kinds.colors.push_back(part->color_rgb);
  }
  return kinds;
}

sim_cell::PhysicsCellOptions layout(const CellConfig& config) {
  sim_cell::PhysicsCellOptions options;
  options.bin = *config.bin;
  options.T_base_camera = *config.T_base_camera;
  options.gripper = config.gripper;
  options.seed = config.pile->seed;
  if (config.motion->parameters.place_bin) options.place = *config.motion->parameters.place_bin;
  return options;
}

}  // namespace

Result<Equipment> make_simulated_equipment(const CellConfig& config) {
  auto model = motion::ArmModel::load(config.motion->urdf);
  if (!model) return tl::unexpected(model.error());
  const auto& angles_rad = config.motion->out_of_view_rad;
  const agent::Joints out_of_view_rad =
      Eigen::Map<const agent::Joints>(angles_rad.data(), std::ssize(angles_rad));
  motion::MotionParameters parameters = config.motion->parameters;
  parameters.gripper = config.gripper;

  auto kinds = kinds_of(config);
  if (!kinds) return tl::unexpected(kinds.error());
  const auto simulated = std::make_shared<Simulated>();
  simulated->kinds = std::move(kinds->meshes);
  const sim_cell::PileMaker piles(simulated->kinds);
  const std::vector<int> counts(simulated->kinds.size(), static_cast<int>(config.pile->count_n));
  const auto pile = piles.drop(counts, config.bin->inner_size_m, config.pile->seed);
  if (!pile) return tl::unexpected(pile.error());
  if (model->joints_n() != out_of_view_rad.size()) {
    return invalid("out_of_view_rad: {} angles; {} has {} joints", out_of_view_rad.size(),
                   config.motion->urdf.string(), model->joints_n());
  }
  simulated->cell.emplace(simulated->kinds, *pile, layout(config),
                          agent::SimArm{*model, parameters.T_flange_grasp, out_of_view_rad},
                          agent::FloatingOptions{});
  auto arm = motion::PlannedArm::create(simulated->cell->joint_driver(), *model, parameters,
                                        out_of_view_rad);
  if (!arm) return tl::unexpected(arm.error());
  simulated->arm = *std::move(arm);

  agent::SimCell& cell = *simulated->cell;
  if (!config.pile->film.empty()) simulated->film.emplace(cell.physics(), kinds->colors);

  Equipment equipment;
  equipment.clock = {simulated, &cell.clock()};
  equipment.camera = {simulated, &cell.camera()};
  equipment.arm = {simulated, simulated->arm.get()};
  equipment.gripper = {simulated, &cell.gripper()};
  equipment.timed = [&cell](agent::Planner& planner) -> agent::Planner& {
    return cell.timed(planner);
  };
  equipment.finish = [simulated, path = config.pile->film] {
    return simulated->film ? simulated->film->write(path) : Result<void>();
  };
  return equipment;
}

}  // namespace graspd::robot_agent
