#include "arm_config.hpp"

#include "graspd/formats/cell.hpp"

namespace graspd::robot_agent {
namespace {

std::filesystem::path read_input(YamlMap& map, std::string_view key,
                                 const std::filesystem::path& input) {
  std::string text;
  map.required(key, text);
  return input / text;
}

}  // namespace

MotionConfig read_motion(YamlMap map, const std::filesystem::path& input) {
  MotionConfig config;
  motion::MotionParameters& parameters = config.parameters;
  config.urdf = read_input(map, "urdf", input);
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

PileConfig read_pile(YamlMap map, const std::filesystem::path& input,
                     const std::filesystem::path& output) {
  PileConfig config;
  config.parts = read_input(map, "parts", input);
  map.optional("count_n", config.count_n);
  map.optional("seed", config.seed);
  std::string film;
  map.optional("film", film);
  if (!film.empty()) config.film = output / film;
  if (config.count_n == 0) map.fault("count_n", "'count_n' must be at least 1");
  return config;
}

}  // namespace graspd::robot_agent
