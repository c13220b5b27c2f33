#include "simulated_equipment.hpp"

#include "driven_arm.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/simulated/film.hpp"

namespace graspd::robot_agent {
namespace {

/// What a simulated cell is made of; all of it lives as long as any of its ports.
struct Simulated {
  std::vector<parts::Mesh> kinds;
  std::unique_ptr<agent::SimCell> cell;
  std::optional<agent::Film> film;
};

/// The parts that may be in the bin.
struct Kinds {
  std::vector<parts::Mesh> meshes;
  std::vector<simulation::Rgb> colors;
};

Result<Kinds> kinds_of(const CellConfig& config) {
  const auto catalogue = parts::Catalogue::load(config.arm.pile->parts);
  if (!catalogue) return tl::unexpected(catalogue.error());
  Kinds kinds;
  for (const RequestedPart& requested : config.parts) {
    const parts::Part* part = catalogue->find(requested.id);
    if (part == nullptr) {
      return fail(Code::kUnknownPart, "parts: {} has no part '{}'", config.arm.pile->parts.string(),
                  requested.id);
    }
    kinds.meshes.push_back(part->mesh);
    kinds.colors.push_back(part->color_rgb);
  }
  return kinds;
}

}  // namespace

sim_cell::PhysicsCellOptions layout(const CellConfig& config) {
  sim_cell::PhysicsCellOptions options;
  options.bin = *config.bin;
  options.T_base_camera = *config.T_base_camera;
  options.gripper = config.gripper;
  // A cell's frames count on from its seed: no two piles' frames have the same noise.
  options.seed = static_cast<std::uint64_t>(config.arm.pile->seed) << 16;
  if (config.arm.motion->parameters.place_bin)
    options.place = *config.arm.motion->parameters.place_bin;
  return options;
}

Result<Equipment> make_simulated_equipment(const CellConfig& config) {
  const auto arm = load_arm(config);
  if (!arm) return tl::unexpected(arm.error());
  auto kinds = kinds_of(config);
  if (!kinds) return tl::unexpected(kinds.error());
  const auto simulated = std::make_shared<Simulated>();
  simulated->kinds = std::move(kinds->meshes);
  const simulation::PileMaker piles(simulated->kinds);
  const std::vector<int> counts(simulated->kinds.size(),
                                static_cast<int>(config.arm.pile->count_n));
  const auto pile = piles.drop(counts, config.bin->inner_size_m, config.arm.pile->seed);
  if (!pile) return tl::unexpected(pile.error());
  auto made = agent::SimCell::create(simulated->kinds, *pile, layout(config), *arm);
  if (!made) return tl::unexpected(made.error());
  simulated->cell = *std::move(made);

  agent::SimCell& cell = *simulated->cell;
  if (!config.arm.pile->film.empty()) simulated->film.emplace(cell.physics(), kinds->colors);

  Equipment equipment;
  equipment.clock = {simulated, &cell.clock()};
  equipment.camera = {simulated, &cell.camera()};
  equipment.arm = {simulated, &cell.arm()};
  equipment.gripper = {simulated, &cell.gripper()};
  equipment.timed = [&cell](agent::Planner& planner) -> agent::Planner& {
    return cell.timed(planner);
  };
  equipment.finish = [simulated, path = config.arm.pile->film] {
    return simulated->film ? simulated->film->write(path) : Result<void>();
  };
  return equipment;
}

}  // namespace graspd::robot_agent
