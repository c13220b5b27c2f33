#include "graspd/simulated/sim_cell.hpp"

#include <deque>
#include <stdexcept>

#include "floating_arm.hpp"
#include "graspd/motion/planned_arm.hpp"
#include "sim_clock.hpp"
#include "sim_joint_driver.hpp"

namespace graspd::agent {
namespace {

constexpr double kExposure_s = 1.0 / 30;

class SimCamera final : public Camera {
 public:
  SimCamera(sim_cell::PhysicsCell& cell, Clock& clock) : cell_(cell), clock_(clock) {}
  Result<std::optional<DepthFrame>> next() override {
    const auto stamp = clock_.now();
    cell_.wait(kExposure_s);
    DepthFrame frame = cell_.frame();
    frame.stamp = stamp;
    return frame;
  }

 private:
  sim_cell::PhysicsCell& cell_;
  Clock& clock_;
};

class SimGripper final : public Gripper {
 public:
  explicit SimGripper(sim_cell::PhysicsCell& cell) : cell_(cell) {}
  Result<void> open(double opening_width_m) override {
    cell_.open(opening_width_m);
    return {};
  }
  Result<void> close() override {
    cell_.close();
    return {};
  }
  Result<bool> holds_something() override { return cell_.holds_something(); }

 private:
  sim_cell::PhysicsCell& cell_;
};

/// Links and start of the robot.
sim_cell::PhysicsCellOptions with(const motion::MountedArm& arm,
                                  sim_cell::PhysicsCellOptions options) {
  options.links.assign(arm.model.links().begin(), arm.model.links().end());
  options.start = robot_pose(arm, arm.out_of_view_rad);
  return options;
}

sim_cell::PhysicsCellOptions with(const FloatingOptions& floating,
                                  sim_cell::PhysicsCellOptions options) {
  options.links.clear();
  options.start = {floating.T_base_out_of_view, {}};
  return options;
}

}  // namespace

struct SimCell::Impl {
  Impl(const std::vector<parts::Mesh>& kinds, const simulation::Pile& pile,
       const sim_cell::PhysicsCellOptions& options)
      : cell(kinds, pile, options) {}

  sim_cell::PhysicsCell cell;
  SimClock clock{cell};
  SimCamera camera{cell, clock};
  SimGripper gripper{cell};
  std::unique_ptr<SimJointDriver> joint_driver;  ///< none: the gripper floats
  std::unique_ptr<Arm> arm;
  std::deque<TimedPlanner> planners;

  Result<void> carry(const motion::MountedArm& by) {
    joint_driver = std::make_unique<SimJointDriver>(cell, by);
    auto planned = motion::PlannedArm::create(*joint_driver, by);
    if (!planned) return tl::unexpected(planned.error());
    arm = *std::move(planned);
    return {};
  }
  Result<void> carry(const FloatingOptions& by) {
    arm = std::make_unique<FloatingArm>(cell, by);
    return {};
  }
};

Result<std::unique_ptr<SimCell>> SimCell::create(
    const std::vector<parts::Mesh>& kinds, const simulation::Pile& pile,
    const sim_cell::PhysicsCellOptions& options,
    const std::variant<motion::MountedArm, FloatingOptions>& carrier) {
  auto impl = std::make_unique<Impl>(
      kinds, pile, std::visit([&](const auto& by) { return with(by, options); }, carrier));
  const auto ok = std::visit([&](const auto& by) { return impl->carry(by); }, carrier);
  if (!ok) return tl::unexpected(ok.error());
  return std::unique_ptr<SimCell>(new SimCell(std::move(impl)));
}

SimCell::SimCell(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SimCell::~SimCell() = default;

Camera& SimCell::camera() { return impl_->camera; }
Arm& SimCell::arm() { return *impl_->arm; }
Gripper& SimCell::gripper() { return impl_->gripper; }
Clock& SimCell::clock() { return impl_->clock; }

JointDriver& SimCell::joint_driver() {
  if (!impl_->joint_driver) throw std::logic_error("simulated cell: no arm carries its gripper");
  return *impl_->joint_driver;
}

Planner& SimCell::timed(Planner& planner) {
  return impl_->planners.emplace_back(planner, impl_->clock);
}

sim_cell::PhysicsCell& SimCell::physics() { return impl_->cell; }

}  // namespace graspd::agent
