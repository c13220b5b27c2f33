#include "graspd/sim_cell/physics_cell.hpp"

#include <algorithm>
#include <cmath>

#include "physics_cell_impl.hpp"

namespace graspd::sim_cell {
namespace {

/// The jaws stand when they have moved by less than this for so long.
constexpr double kJawsStand_m = 0.00005;
constexpr double kJawsStandFor_s = 0.1;
constexpr double kCloseWithin_s = 3;
constexpr double kBetweenJaws_m = 0.001;

/// After a stop the arm may move so long against what stopped it, or it would never come free.
constexpr double kBackOff_s = 0.2;

}  // namespace

PhysicsCell::PhysicsCell(const std::vector<parts::Mesh>& kinds, const simulation::Pile& pile,
                         const PhysicsCellOptions& options)
    : impl_(std::make_unique<Impl>(kinds, pile, options)) {}
PhysicsCell::~PhysicsCell() = default;

const PhysicsCellOptions& PhysicsCell::options() const { return impl_->options; }
double PhysicsCell::time_s() const { return impl_->time_s; }

Result<void> PhysicsCell::follow(double duration_s,
                                 const std::function<RobotPose(double)>& robot_at) {
  if (!(duration_s > 0)) return {};
  impl_->has_worked = true;
  const int steps_n = impl_->steps_in(duration_s);
  for (int i = 1; i <= steps_n; ++i) {
    const RobotPose robot = robot_at(duration_s * i / steps_n);
    impl_->links.move_in_next_step(robot.T_base_links, impl_->T_bin_base);
    const Resistance resistance = impl_->step(
        duration_s / steps_n, impl_->T_bin_base * robot.T_base_grasp, impl_->gripper.opening_m());
    const bool backs_off = impl_->is_stalled && duration_s * i / steps_n < kBackOff_s;
    if (backs_off || !resistance.is_stalling()) continue;
    impl_->is_stalled = true;
    ++impl_->stalls_n;
    return fail(Code::kInternal, "the arm met resistance: {} against {}; it stands where that was",
                resistance.by, resistance.what);
  }
  impl_->is_stalled = false;
  return {};
}

int PhysicsCell::stalls_n() const { return impl_->stalls_n; }

void PhysicsCell::open(double opening_m) {
  const Gripper& gripper = impl_->options.gripper;
  const double to_m = std::clamp(opening_m, gripper.min_opening_m, gripper.max_opening_m);
  impl_->gripper.let_go();
  impl_->has_worked = true;
  impl_->has_closed = false;
  const double from_m = impl_->gripper.opening_m();
  const double duration_s = std::abs(to_m - from_m) / (2 * impl_->options.drive.speed_m_s);
  const int steps_n = static_cast<int>(std::ceil(duration_s / impl_->step_s()));
  for (int i = 1; i <= steps_n; ++i) {
    impl_->step(duration_s / steps_n, impl_->gripper.T_bin_grasp(),
                from_m + (to_m - from_m) * i / steps_n);
  }
}

void PhysicsCell::close() {
  impl_->gripper.grip();
  impl_->has_worked = true;
  impl_->has_closed = true;
  impl_->recorder.closes();
  const double start_s = impl_->time_s;
  double window_s = impl_->time_s, window_m = impl_->gripper.opening_m();
  while (impl_->time_s < start_s + kCloseWithin_s) {
    impl_->stand(impl_->step_s());
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
  if (impl_->has_worked) {
    impl_->take_stock();
    impl_->has_worked = false;
  }
  return impl_->observe_cell();
}

std::vector<CellPart> PhysicsCell::parts() const {
  std::vector<CellPart> parts;
  for (std::size_t i = 0; i < impl_->parts.size(); ++i) {
    const bool is_lost = std::ranges::count(impl_->lost, i) > 0;
    parts.push_back({impl_->parts.kind(i), impl_->T_base_bin * impl_->parts.T_bin_part(i),
                     impl_->parts.is_gone(i) && !is_lost, is_lost});
  }
  return parts;
}

std::optional<std::size_t> PhysicsCell::part_at(std::size_t kind,
                                                const Eigen::Isometry3d& T_base_part) const {
  const simulation::PartShape& shape = impl_->shapes[kind];
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

void PhysicsCell::every(double period_s, std::function<void()> watch) {
  impl_->watch = std::move(watch);
  impl_->watch_every_s = period_s;
  impl_->watch_next_s = impl_->time_s;
}

const PickTrace& PhysicsCell::last_trace() const { return impl_->last_trace; }

}  // namespace graspd::sim_cell
