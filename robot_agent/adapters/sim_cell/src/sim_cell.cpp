#include "graspd/simulated/sim_cell.hpp"

#include <deque>
#include <stdexcept>

#include "floating_arm.hpp"
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

sim_cell::PhysicsCellOptions with(const std::optional<SimArm>& arm,
                                  sim_cell::PhysicsCellOptions options) {
  if (!arm) return options;
  options.links.assign(arm->model.links().begin(), arm->model.links().end());
  options.start = robot_pose(*arm, arm->start_q_rad);
  return options;
}

}  // namespace

struct SimCell::Impl {
  Impl(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
       const sim_cell::PhysicsCellOptions& options)
      : cell(kinds, pile, options) {}

  sim_cell::PhysicsCell cell;
  SimClock clock{cell};
  SimCamera camera{cell, clock};
  SimGripper gripper{cell};
  std::optional<SimJointDriver> joint_driver;
  std::optional<FloatingArm> floating_arm;
  std::deque<TimedPlanner> planners;
};

SimCell::SimCell(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
                 sim_cell::PhysicsCellOptions options, std::optional<SimArm> arm,
                 const FloatingOptions& floating)
    : impl_(std::make_unique<Impl>(kinds, pile, with(arm, std::move(options)))) {
  if (arm) {
    impl_->joint_driver.emplace(impl_->cell, *std::move(arm));
  } else {
    impl_->floating_arm.emplace(impl_->cell, floating);
  }
}
SimCell::~SimCell() = default;

Camera& SimCell::camera() { return impl_->camera; }
Gripper& SimCell::gripper() { return impl_->gripper; }
Clock& SimCell::clock() { return impl_->clock; }

JointDriver& SimCell::joint_driver() {
  if (!impl_->joint_driver) throw std::logic_error("simulated cell: no arm carries its gripper");
  return *impl_->joint_driver;
}

Arm& SimCell::floating_arm() {
  if (!impl_->floating_arm) throw std::logic_error("simulated cell: an arm carries its gripper");
  return *impl_->floating_arm;
}

Planner& SimCell::timed(Planner& planner) {
  return impl_->planners.emplace_back(planner, impl_->clock);
}

sim_cell::PhysicsCell& SimCell::physics() { return impl_->cell; }

}  // namespace graspd::agent
