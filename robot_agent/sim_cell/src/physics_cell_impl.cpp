#include "physics_cell_impl.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graspd/simulation/bin_mesh.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kCoarseStep_s = 1.0 / 120;
constexpr int kCoarseIterations = 30;
/// While something is gripped: with longer steps or fewer iterations it creeps out.
constexpr double kFineStep_s = 1.0 / 480;
constexpr int kFineIterations = 100;

constexpr double kAirDamping = 0.3;

std::vector<simulation::PartShape> shapes_of(const std::vector<parts::Mesh>& kinds,
                                             double density_kg_m3) {
  std::vector<simulation::PartShape> shapes;
  for (const parts::Mesh& mesh : kinds)
    shapes.push_back(simulation::make_part_shape(mesh, {}, density_kg_m3));
  return shapes;
}

}  // namespace

PhysicsCell::Impl::Impl(const std::vector<parts::Mesh>& meshes, const simulation::Pile& pile,
                        const PhysicsCellOptions& given)
    : kinds(meshes),
      options(given),
      T_base_bin(given.bin.T_base_bin),
      T_bin_base(given.bin.T_base_bin.inverse()),
      shapes(shapes_of(meshes, given.parts.density_kg_m3)),
      world(given.bin.inner_size_m, given.parts.friction, given.parts.restitution),
      obstacles(world, given.bin, given.place),
      parts(world, shapes, pile),
      gripper(world, given.gripper, given.drive, given.parts.friction,
              T_bin_base * given.start.T_base_grasp),
      links(world, given.links),
      recorder(parts),
      bin(simulation::bin_mesh(given.bin.inner_size_m, given.bin.wall_thickness_m)) {
  parts.set_damping(kAirDamping);
  links.move_in_next_step(given.start.T_base_links, T_bin_base);
  world.step(0);
}

double PhysicsCell::Impl::step_s() const {
  return gripper.is_gripping() ? kFineStep_s : kCoarseStep_s;
}

int PhysicsCell::Impl::steps_in(double duration_s) const {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(duration_s / step_s() - kRounding)));
}

Resistance PhysicsCell::Impl::step(double step_s, const Eigen::Isometry3d& T_bin_grasp,
                                   double opening_m) {
  world.set_solver_iterations(gripper.is_gripping() ? kFineIterations : kCoarseIterations);
  gripper.move_in_next_step(T_bin_grasp, opening_m);
  world.step(step_s);
  time_s += step_s;
  if (watch && time_s >= watch_next_s) {
    watch_next_s += watch_every_s;
    watch();
  }
  const std::vector<simulation::Contact> contacts = world.contacts();
  parts.update(contacts, step_s);
  if (gripper.is_gripping() && !is_settling &&
      parts.pause_if_clear(contacts, T_bin_grasp.translation().z())) {
    paused_at_s = paused_at_s.value_or(time_s);
  }
  return recorder.record(contacts, step_s, gripper.is_gripping());
}

void PhysicsCell::Impl::stand(double duration_s) {
  const int steps_n = steps_in(duration_s);
  for (int i = 0; i < steps_n; ++i) {
    step(duration_s / steps_n, gripper.T_bin_grasp(), gripper.opening_m());
  }
}

void PhysicsCell::Impl::settle() {
  parts.resume();
  is_settling = true;
  const double credit_s = time_s - std::exchange(paused_at_s, {}).value_or(time_s);
  const double start_s = time_s;
  while (parts.is_any_loose() && time_s < start_s + options.settle_within_s) {
    parts.set_damping(simulation::settling_damping(time_s - start_s, kAirDamping));
    step(step_s(), gripper.T_bin_grasp(), gripper.opening_m());
  }
  // What creeps on, in the thickest air, does so by how contacts are solved: a pile at rest stays.
  // Else frames that are taken one after another would not show the same pile.
  parts.rest();
  parts.set_damping(kAirDamping);
  is_settling = false;
  time_s = std::max(start_s, time_s - credit_s);
}

void PhysicsCell::Impl::take_stock() {
  const std::vector<std::size_t> placed = parts_in_place_box();
  last_trace = recorder.finish(placed);
  for (const std::size_t part : placed) parts.take_away(part);
  for (const std::size_t part : parts_on_table()) {
    parts.take_away(part);
    lost.push_back(part);
  }
  T_base_parts_at_frame.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    T_base_parts_at_frame.push_back(T_base_bin * parts.T_bin_part(i));
  }
}

std::vector<std::size_t> PhysicsCell::Impl::parts_in_place_box() const {
  const Eigen::Isometry3d T_place_bin = options.place.T_base_bin.inverse() * T_base_bin;
  const Eigen::Vector3d half_m = options.place.inner_size_m / 2;
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Eigen::Vector3d p_m = T_place_bin * parts.centre_m(i);
    if (!parts.is_gone(i) && !parts.is_touched(i) && std::abs(p_m.x()) < half_m.x() &&
        std::abs(p_m.y()) < half_m.y() &&
        p_m.z() < options.place.inner_size_m.z() + parts.shape(i).radius_m) {
      inside.push_back(i);
    }
  }
  return inside;
}

/// Lower than the bin's rim: what lies on that stays, and what the gripper carries is higher. The
/// robot may touch them: they lie against its foot.
std::vector<std::size_t> PhysicsCell::Impl::parts_on_table() const {
  const Eigen::Vector3d half_m =
      options.bin.inner_size_m / 2 + Eigen::Vector3d::Constant(options.bin.wall_thickness_m);
  std::vector<std::size_t> outside;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Eigen::Vector3d p_m = parts.centre_m(i);
    const bool is_beside = std::abs(p_m.x()) > half_m.x() || std::abs(p_m.y()) > half_m.y();
    if (!parts.is_gone(i) && is_beside && p_m.z() < options.bin.inner_size_m.z()) {
      outside.push_back(i);
    }
  }
  return outside;
}

}  // namespace graspd::sim_cell
