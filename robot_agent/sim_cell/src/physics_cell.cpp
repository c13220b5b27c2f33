#include "graspd/sim_cell/physics_cell.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graspd/sim_cell/bin_mesh.hpp"
#include "gripper_bodies.hpp"
#include "link_bodies.hpp"
#include "obstacles.hpp"
#include "part_bodies.hpp"
#include "trace_recorder.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kCoarseStep_s = 1.0 / 120;
constexpr int kCoarseIterations = 30;
/// While something is gripped: with longer steps or fewer iterations it creeps out.
constexpr double kFineStep_s = 1.0 / 480;
constexpr int kFineIterations = 100;

/// The jaws stand when they have moved by less than this for so long.
constexpr double kJawsStand_m = 0.00005;
constexpr double kJawsStandFor_s = 0.1;
constexpr double kCloseWithin_s = 3;
constexpr double kBetweenJaws_m = 0.001;

/// After a stop the arm may move so long against what stopped it, or it would never come free.
constexpr double kBackOff_s = 0.2;

constexpr double kSettleWithin_s = 4;
/// While the pile settles the air thickens, as when it was made.
constexpr double kThickening_s = 0.3;
constexpr double kAirDamping = 0.3;

std::vector<PartShape> shapes_of(const std::vector<parts::Mesh>& kinds, double density_kg_m3) {
  std::vector<PartShape> shapes;
  for (const parts::Mesh& mesh : kinds) shapes.push_back(make_part_shape(mesh, {}, density_kg_m3));
  return shapes;
}

}  // namespace

struct PhysicsCell::Impl {
  const std::vector<parts::Mesh>& kinds;
  PhysicsCellOptions options;
  Eigen::Isometry3d T_base_bin, T_bin_base;
  std::vector<PartShape> shapes;
  BulletWorld world;
  Obstacles obstacles;
  PartBodies parts;
  GripperBodies gripper;
  LinkBodies links;
  TraceRecorder recorder;
  parts::Mesh bin;
  PickTrace last_trace;
  std::vector<Eigen::Isometry3d> T_base_parts_at_frame;
  double time_s = 0;
  bool is_settling = false;
  std::optional<double> paused_at_s;  ///< since then parts wait to move on
  std::uint64_t frames_n = 0;
  bool is_stalled = false;
  bool has_closed = false;  ///< the jaws are closed, on something or on nothing

  Impl(const std::vector<parts::Mesh>& meshes, const Pile& pile, const PhysicsCellOptions& given)
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
        bin(bin_mesh(given.bin.inner_size_m, given.bin.wall_thickness_m)) {
    parts.set_damping(kAirDamping);
    links.move_in_next_step(given.start.T_base_links, T_bin_base);
    world.step(0);
  }

  double step_s() const { return gripper.is_gripping() ? kFineStep_s : kCoarseStep_s; }

  /// One step in which the gripper moves to a pose. \returns the worst resistance to it
  Resistance step(double step_s, const Eigen::Isometry3d& T_bin_grasp, double opening_m) {
    world.set_solver_iterations(gripper.is_gripping() ? kFineIterations : kCoarseIterations);
    gripper.move_in_next_step(T_bin_grasp, opening_m);
    world.step(step_s);
    time_s += step_s;
    const std::vector<Contact> contacts = world.contacts();
    parts.update(contacts, step_s);
    if (gripper.is_gripping() && !is_settling &&
        parts.pause_if_clear(contacts, T_bin_grasp.translation().z())) {
      paused_at_s = paused_at_s.value_or(time_s);
    }
    return recorder.record(contacts, step_s, gripper.is_gripping());
  }

  void stand(double duration_s) {
    const int steps_n = steps_in(duration_s);
    for (int i = 0; i < steps_n; ++i) {
      step(duration_s / steps_n, gripper.T_bin_grasp(), gripper.opening_m());
    }
  }

  int steps_in(double duration_s) const {
    return std::max(1, static_cast<int>(std::ceil(duration_s / step_s() - 1e-9)));
  }

  /// What waited while the gripper was at work moves now, in the time that has passed since.
  void settle() {
    parts.resume();
    is_settling = true;
    const double credit_s = time_s - std::exchange(paused_at_s, {}).value_or(time_s);
    const double start_s = time_s;
    while (parts.is_any_loose() && time_s < start_s + kSettleWithin_s) {
      const double tens = (time_s - start_s) / kThickening_s;
      parts.set_damping(std::max(kAirDamping, 1 - std::pow(0.1, tens)));
      step(step_s(), gripper.T_bin_grasp(), gripper.opening_m());
    }
    parts.set_damping(kAirDamping);
    is_settling = false;
    time_s = std::max(start_s, time_s - credit_s);
  }

  std::vector<std::size_t> parts_in_place_box() const {
    const Eigen::Isometry3d T_place_bin = options.place.T_base_bin.inverse() * T_base_bin;
    const Eigen::Vector3d half_m = options.place.inner_size_m / 2;
    std::vector<std::size_t> inside;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Eigen::Vector3d p_m = T_place_bin * parts.centre_m(i);
      if (!parts.is_gone(i) && !parts.is_touched(i) && std::abs(p_m.x()) < half_m.x() &&
          std::abs(p_m.y()) < half_m.y() && p_m.z() < options.place.inner_size_m.z()) {
        inside.push_back(i);
      }
    }
    return inside;
  }

  DepthFrame observe_cell() {
    const Eigen::Isometry3d T_camera_base = options.T_base_camera.inverse();
    std::vector<SceneObject> scene;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts.is_gone(i)) continue;
      scene.push_back(
          {&kinds[parts.kind(i)], T_camera_base * T_base_bin * parts.T_bin_part(i), options.gloss});
    }
    scene.push_back({&bin, T_camera_base * T_base_bin});
    const Walls walls{T_camera_base * T_base_bin, options.bin.inner_size_m};
    return observe(scene, options.sensor, options.seed + frames_n++, &walls);
  }
};

PhysicsCell::PhysicsCell(const std::vector<parts::Mesh>& kinds, const Pile& pile,
                         const PhysicsCellOptions& options)
    : impl_(std::make_unique<Impl>(kinds, pile, options)) {}
PhysicsCell::~PhysicsCell() = default;

const PhysicsCellOptions& PhysicsCell::options() const { return impl_->options; }
double PhysicsCell::time_s() const { return impl_->time_s; }

Result<void> PhysicsCell::follow(double duration_s,
                                 const std::function<RobotPose(double)>& robot_at) {
  if (!(duration_s > 0)) return {};
  const int steps_n = impl_->steps_in(duration_s);
  for (int i = 1; i <= steps_n; ++i) {
    const RobotPose robot = robot_at(duration_s * i / steps_n);
    impl_->links.move_in_next_step(robot.T_base_links, impl_->T_bin_base);
    const Resistance resistance = impl_->step(
        duration_s / steps_n, impl_->T_bin_base * robot.T_base_grasp, impl_->gripper.opening_m());
    const bool backs_off = impl_->is_stalled && duration_s * i / steps_n < kBackOff_s;
    if (backs_off || !resistance.is_stalling()) continue;
    impl_->is_stalled = true;
    return fail(Code::kInternal, "the arm met resistance: {} against {}; it stands where that was",
                resistance.by, resistance.what);
  }
  impl_->is_stalled = false;
  return {};
}

void PhysicsCell::open(double opening_m) {
  const Gripper& gripper = impl_->options.gripper;
  const double to_m = std::clamp(opening_m, gripper.min_opening_m, gripper.max_opening_m);
  impl_->gripper.let_go();
  impl_->has_closed = false;
  const double from_m = impl_->gripper.opening_m();
  const double duration_s = std::abs(to_m - from_m) / (2 * impl_->options.drive.speed_m_s);
  const int steps_n = static_cast<int>(std::ceil(duration_s / kFineStep_s));
  for (int i = 1; i <= steps_n; ++i) {
    impl_->step(duration_s / steps_n, impl_->gripper.T_bin_grasp(),
                from_m + (to_m - from_m) * i / steps_n);
  }
}

void PhysicsCell::close() {
  impl_->gripper.grip();
  impl_->has_closed = true;
  impl_->recorder.closes();
  const double start_s = impl_->time_s;
  double window_s = impl_->time_s, window_m = impl_->gripper.opening_m();
  while (impl_->time_s < start_s + kCloseWithin_s) {
    impl_->stand(kFineStep_s);
    if (impl_->time_s < window_s + kJawsStandFor_s) continue;
    if (std::abs(impl_->gripper.opening_m() - window_m) < kJawsStand_m) break;
    window_s = impl_->time_s;
    window_m = impl_->gripper.opening_m();
  }
}

void PhysicsCell::wait(double duration_s) {
  if (duration_s > 0) impl_->stand(duration_s);
}

double PhysicsCell::opening_m() const { return impl_->gripper.opening_m(); }

Eigen::Isometry3d PhysicsCell::T_base_grasp() const {
  return impl_->T_base_bin * impl_->gripper.T_bin_grasp();
}

bool PhysicsCell::holds_something() const {
  return impl_->has_closed &&
         impl_->gripper.opening_m() > impl_->options.gripper.min_opening_m + kBetweenJaws_m;
}

DepthFrame PhysicsCell::frame() {
  impl_->settle();
  const std::vector<std::size_t> placed = impl_->parts_in_place_box();
  impl_->last_trace = impl_->recorder.finish(placed);
  for (const std::size_t part : placed) impl_->parts.take_away(part);
  impl_->T_base_parts_at_frame.clear();
  for (const CellPart& part : parts()) {
    impl_->T_base_parts_at_frame.push_back(part.T_base_part);
  }
  return impl_->observe_cell();
}

std::vector<CellPart> PhysicsCell::parts() const {
  std::vector<CellPart> parts;
  for (std::size_t i = 0; i < impl_->parts.size(); ++i) {
    parts.push_back({impl_->parts.kind(i), impl_->T_base_bin * impl_->parts.T_bin_part(i),
                     impl_->parts.is_gone(i)});
  }
  return parts;
}

std::optional<std::size_t> PhysicsCell::part_at(std::size_t kind,
                                                const Eigen::Isometry3d& T_base_part) const {
  const PartShape& shape = impl_->shapes[kind];
  std::optional<std::size_t> nearest;
  double nearest_m = shape.radius_m;
  for (std::size_t i = 0; i < impl_->T_base_parts_at_frame.size(); ++i) {
    if (impl_->parts.kind(i) != kind) continue;
    const double distance_m = (impl_->T_base_parts_at_frame[i] * shape.centre_of_mass_m -
                               T_base_part * shape.centre_of_mass_m)
                                  .norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    nearest = i;
  }
  return nearest;
}

const PickTrace& PhysicsCell::last_trace() const { return impl_->last_trace; }

}  // namespace graspd::sim_cell
