#include "driven_arm.hpp"

#ifdef GRASPD_ROS
#include "graspd/ros/driver.hpp"
#endif

namespace graspd::robot_agent {
namespace {

using Driver = Result<std::unique_ptr<agent::JointDriver>>;

Driver connect_simple_message(simple_message::DriverOptions options, const motion::ArmModel& arm) {
  options.joints_n = arm.joints_n();
  return simple_message::connect(options);
}

#ifdef GRASPD_ROS
Driver connect_ros(const RosConfig& config, const motion::ArmModel& arm) {
  ros_arm::DriverOptions options{.joint_names = {},
                                 .command_topic = config.command_topic,
                                 .state_topic = config.state_topic,
                                 .watchdog = config.watchdog,
                                 .limits = config.limits};
  for (const motion::JointLimits& joint : arm.limits()) options.joint_names.push_back(joint.name);
  return ros_arm::connect(options);
}
#else
Driver connect_ros(const RosConfig&, const motion::ArmModel&) {
  return invalid(
      "arm: this robot_agent was built without ROS: build it with -DGRASPD_ROS=ON, after "
      "deploy/install-deps --ros");
}
#endif

Driver connect(const ArmConfig& config, const motion::ArmModel& arm) {
  return config.kind == ArmKind::kRos ? connect_ros(config.ros, arm)
                                      : connect_simple_message(config.simple_message, arm);
}

struct DrivenArm {
  std::unique_ptr<agent::JointDriver> driver;
  std::unique_ptr<motion::PlannedArm> arm;
};

}  // namespace

Result<motion::MountedArm> load_arm(const CellConfig& config) {
  const MotionConfig& of = *config.arm.motion;
  auto model = motion::ArmModel::load(of.urdf);
  if (!model) return tl::unexpected(model.error());
  if (model->joints_n() != std::ssize(of.out_of_view_rad)) {
    return invalid("out_of_view_rad: {} angles; {} has {} joints", of.out_of_view_rad.size(),
                   of.urdf.string(), model->joints_n());
  }
  motion::MountedArm arm{
      *std::move(model), of.parameters,
      Eigen::Map<const agent::Joints>(of.out_of_view_rad.data(), std::ssize(of.out_of_view_rad))};
  arm.parameters.gripper = config.gripper;
  return arm;
}

Result<std::shared_ptr<agent::Arm>> make_driven_arm(const CellConfig& config) {
  const auto mounted = load_arm(config);
  if (!mounted) return tl::unexpected(mounted.error());
  auto driver = connect(config.arm, mounted->model);
  if (!driver) return tl::unexpected(driver.error());
  const auto driven = std::make_shared<DrivenArm>(DrivenArm{*std::move(driver), nullptr});
  auto arm = motion::PlannedArm::create(*driven->driver, *mounted);
  if (!arm) return tl::unexpected(arm.error());
  driven->arm = *std::move(arm);
  return std::shared_ptr<agent::Arm>(driven, driven->arm.get());
}

}  // namespace graspd::robot_agent
