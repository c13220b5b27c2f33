#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "graspd/formats/yaml.hpp"
#include "graspd/motion/motion_parameters.hpp"
#include "graspd/types/request.hpp"

namespace graspd::robot_agent {

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
  std::filesystem::path film;  ///< an animation of the cell; empty: none is made
};

MotionConfig read_motion(YamlMap map, const std::filesystem::path& input);
PileConfig read_pile(YamlMap map, const std::filesystem::path& input,
                     const std::filesystem::path& output);

}  // namespace graspd::robot_agent
