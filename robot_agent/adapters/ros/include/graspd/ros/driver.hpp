#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/agent/motion_watch.hpp"

/// An arm that a cell's own ROS (1, Noetic) drives: a trajectory goes out on `joint_path_command`,
/// `joint_states` tells how it is followed, and an empty trajectory is a stop, as
/// industrial_robot_client has it. Debian has no control_msgs, hence no FollowJointTrajectory.
///
/// Nobody answers on a topic, so that a stop is confirmed by joints that stand still.
namespace graspd::ros_arm {

/// The cell's names in ROS, and what still counts as following.
struct DriverOptions {
  std::vector<std::string> joint_names;  ///< from the base outwards
  std::string command_topic = "joint_path_command";
  std::string state_topic = "joint_states";
  std::chrono::milliseconds watchdog{1000};  ///< without a state
  agent::WatchLimits limits{};
};

/// Needs ROS_MASTER_URI; one process is one node, graspd_robot_agent.
/// \returns UNAVAILABLE where there is no master, nobody takes commands, or no state with all the
/// joints comes within the watchdog's time.
Result<std::unique_ptr<agent::JointDriver>> connect(const DriverOptions& options);

}  // namespace graspd::ros_arm
