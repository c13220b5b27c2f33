#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "graspd/formats/yaml.hpp"
#include "graspd/motion/motion_parameters.hpp"
#include "graspd/simple_message/driver.hpp"

namespace graspd::robot_agent {

enum class ArmKind { kRecord, kSimulated, kSimpleMessage, kRos };

/// An arm whose motions are planned here.
struct MotionConfig {
  std::filesystem::path urdf;
  motion::MotionParameters parameters;  ///< the gripper is the cell's own
  std::vector<double> out_of_view_rad;
};

/// A pile in a simulated cell.
struct PileConfig {
  std::filesystem::path parts;  ///< the catalogue's folder
  std::uint32_t count_n = 30;   ///< of each part that the cell asks for
  std::uint32_t seed = 1;
  std::filesystem::path film;  ///< an animation of the cell, and a PNG beside it; empty: none
};

/// As ros_arm::DriverOptions, which is not in every build.
struct RosConfig {
  std::string command_topic = "joint_path_command";
  std::string state_topic = "joint_states";
  std::chrono::milliseconds watchdog{1000};
  agent::WatchLimits limits;
};

/// The section `arm`.
struct ArmConfig {
  ArmKind kind = ArmKind::kRecord;
  std::filesystem::path record;                  ///< of an arm that only writes down
  std::optional<MotionConfig> motion;            ///< of every other
  std::optional<PileConfig> pile;                ///< of a simulated cell
  simple_message::DriverOptions simple_message;  ///< but for the joints, which the URDF says
  RosConfig ros;
};

/// \param input what is read is relative to this folder. \param output what is written is to this.
ArmConfig read_arm(YamlMap map, const std::filesystem::path& input,
                   const std::filesystem::path& output);

}  // namespace graspd::robot_agent

template <>
struct graspd::EnumNames<graspd::robot_agent::ArmKind> {
  using Kind = robot_agent::ArmKind;
  static constexpr std::string_view what = "kind of arm";
  static constexpr std::pair<Kind, std::string_view> values[] = {
      {Kind::kRecord, "record"},
      {Kind::kSimulated, "simulated"},
      {Kind::kSimpleMessage, "simple_message"},
      {Kind::kRos, "ros"}};
};
