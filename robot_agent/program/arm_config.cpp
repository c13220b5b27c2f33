#include "arm_config.hpp"

#include <limits>

#include "config_values.hpp"
#include "graspd/formats/cell.hpp"

namespace graspd::robot_agent {
namespace {

namespace fs = std::filesystem;

MotionConfig read_motion(YamlMap map, const fs::path& input) {
  MotionConfig config;
  motion::MotionParameters& parameters = config.parameters;
  config.urdf = require_path(map, "urdf", input);
  map.optional_enum("ik", parameters.ik);
  map.required("T_flange_grasp", parameters.T_flange_grasp);
  map.required("out_of_view_rad", config.out_of_view_rad);
  map.optional("allow_turned_gripper", parameters.allow_turned_gripper);
  map.optional("held_radius_m", parameters.held_radius_m);
  if (map.has("table_z_m")) map.required("table_z_m", parameters.table_z_m.emplace());
  if (map.has("place_bin")) parameters.place_bin = read_bin(map.map("place_bin"));
  map.optional("margin_m", parameters.margin_m);
  map.optional("max_straight_speed_m_s", parameters.max_straight_speed_m_s);
  map.optional("max_tries_n", parameters.max_tries_n);
  return config;
}

PileConfig read_pile(YamlMap map, const fs::path& input, const fs::path& output) {
  PileConfig config;
  config.parts = require_path(map, "parts", input);
  map.optional("count_n", config.count_n);
  map.optional("seed", config.seed);
  config.film = read_path(map, "film", output);
  if (config.count_n == 0) map.fault("count_n", "'count_n' must be at least 1");
  return config;
}

void read_limits(YamlMap& map, agent::WatchLimits& limits) {
  read_not_negative(map, "start_tolerance_rad", limits.start_tolerance_rad);
  read_not_negative(map, "goal_tolerance_rad", limits.goal_tolerance_rad);
  read_duration(map, "overtime_s", limits.overtime);
}

void read_port(YamlMap& map, std::string_view key, std::uint16_t& port) {
  std::uint32_t number = port;
  map.optional(key, number);
  if (number == 0 || number > std::numeric_limits<std::uint16_t>::max()) {
    map.fault(key, fmt::format("'{}' must be 1 to 65535", key));
  }
  port = static_cast<std::uint16_t>(number);
}

simple_message::DriverOptions read_simple_message(YamlMap& map) {
  simple_message::DriverOptions options;
  map.required("host", options.host);
  read_port(map, "motion_port", options.motion_port);
  read_port(map, "state_port", options.state_port);
  map.optional("full_speed_rad_s", options.full_speed_rad_s);
  if (!(options.full_speed_rad_s > 0)) {
    map.fault("full_speed_rad_s", "'full_speed_rad_s' must be above 0");
  }
  read_duration(map, "watchdog_s", options.watchdog);
  read_duration(map, "reply_timeout_s", options.reply_timeout);
  read_limits(map, options.limits);
  return options;
}

RosConfig read_ros(YamlMap& map) {
  RosConfig config;
  map.optional("command_topic", config.command_topic);
  map.optional("state_topic", config.state_topic);
  read_duration(map, "watchdog_s", config.watchdog);
  read_limits(map, config.limits);
  return config;
}

}  // namespace

ArmConfig read_arm(YamlMap map, const fs::path& input, const fs::path& output) {
  ArmConfig arm;
  map.optional_enum("kind", arm.kind);
  if (arm.kind != ArmKind::kRecord) arm.motion = read_motion(map.map("motion"), input);
  switch (arm.kind) {
    case ArmKind::kRecord:
      arm.record = read_path(map, "path", output, "arm.jsonl");
      break;
    case ArmKind::kSimulated:
      arm.pile = read_pile(map.map("pile"), input, output);
      break;
    case ArmKind::kSimpleMessage:
      arm.simple_message = read_simple_message(map);
      break;
    case ArmKind::kRos:
      arm.ros = read_ros(map);
      break;
  }
  return arm;
}

}  // namespace graspd::robot_agent
