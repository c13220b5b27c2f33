#pragma once

#include <functional>
#include <memory>

#include "fake_controller.hpp"
#include "graspd/agent/joint_driver.hpp"
#include "graspd/simple_message/driver.hpp"
#include "graspd/simulated/sim_cell.hpp"
#include "motion_support.hpp"
#include "named.hpp"
#include "scripted_cell.hpp"
#ifdef GRASPD_ROS
#include "fake_ros_arm.hpp"
#include "graspd/ros/driver.hpp"
#endif

/// The arms that `joint_driver_contract_test` runs on. Another one is a class that makes it, and
/// its line in `kRigs`.
namespace graspd::testing {

/// A driver with the arm it drives.
class JointDriverRig {
 public:
  virtual ~JointDriverRig() = default;
  virtual agent::JointDriver& driver() = 0;
};

class SimpleMessageRig final : public JointDriverRig {
 public:
  SimpleMessageRig() : controller_({0.F, 0.1F, 0.2F, 0.3F, 0.4F, 0.5F}) {
    simple_message::DriverOptions options;
    options.motion_port = controller_.motion_port();
    options.state_port = controller_.state_port();
    driver_ = simple_message::connect(options).value();
  }
  agent::JointDriver& driver() override { return *driver_; }

 private:
  FakeController controller_;
  std::unique_ptr<agent::JointDriver> driver_;
};

/// The Anno upright, far from the bin.
class SimulatedRig final : public JointDriverRig {
 public:
  agent::JointDriver& driver() override { return cell_->joint_driver(); }

 private:
  static sim_cell::PhysicsCellOptions beside_the_bin() {
    sim_cell::PhysicsCellOptions options = scripted_options();
    options.bin.T_base_bin.translation().x() = 1;
    options.place.T_base_bin.translation().x() = 1.4;
    return options;
  }

  const std::vector<parts::Mesh> kinds_;
  const std::unique_ptr<agent::SimCell> cell_ =
      agent::SimCell::create(kinds_, {}, beside_the_bin(),
                             motion::MountedArm{anno(), {}, agent::Joints::Zero(6)})
          .value();
};

#ifdef GRASPD_ROS
class RosRig final : public JointDriverRig {
 public:
  RosRig() { driver_ = ros_arm::connect({.joint_names = FakeRosArm::joint_names()}).value(); }
  agent::JointDriver& driver() override { return *driver_; }

 private:
  const bool has_master_ = (need_ros_master(), true);  ///< before the arm, which is a node
  FakeRosArm arm_{{0, 0.1, 0.2, 0.3, 0.4, 0.5}};
  std::unique_ptr<agent::JointDriver> driver_;
};
#endif

using NamedRig = Named<std::function<std::unique_ptr<JointDriverRig>()>>;

inline const NamedRig kRigs[] = {
    {"simple_message", make_rig<SimpleMessageRig>},
    {"simulated", make_rig<SimulatedRig>},
#ifdef GRASPD_ROS
    {"ros", make_rig<RosRig>},
#endif
};

}  // namespace graspd::testing
