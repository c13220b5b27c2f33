#pragma once

#include <random>
#include <vector>

#include "block_scene.hpp"
#include "graspd/perception/placed_part.hpp"

/// Piles that can be written down by hand or thrown at random.
namespace graspd::testing {

inline const parts::Part& long_bar() {
  static const parts::Part part = block_part("bar", {0.100, 0.020, 0.010});
  return part;
}

inline perception::PlacedPart placed(
    const parts::Part& part, const Eigen::Vector3d& p_m,
    const Eigen::Vector3d& rotation_rad = Eigen::Vector3d::Zero()) {
  perception::PlacedPart placed{&part, Eigen::Isometry3d::Identity()};
  placed.T_floor_part.translate(p_m);
  const double angle_rad = rotation_rad.norm();
  if (angle_rad > 0)
    placed.T_floor_part.rotate(Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad));
  return placed;
}

/// Parts in a small box, turned at random: many touch and pass through each other, as poses with
/// errors do.
inline std::vector<perception::PlacedPart> random_pile(const parts::Part& part, std::size_t parts_n,
                                                       std::mt19937& random) {
  std::uniform_real_distribution<double> across_m(-0.06, 0.06);
  std::uniform_real_distribution<double> up_m(0.01, 0.07);
  std::normal_distribution<double> turn_rad(0, 1);
  std::vector<perception::PlacedPart> pile;
  for (std::size_t i = 0; i < parts_n; ++i) {
    const double x_m = across_m(random);
    const double y_m = across_m(random);
    const Eigen::Vector3d p_m(x_m, y_m, up_m(random));
    const double a_rad = turn_rad(random);
    const double b_rad = turn_rad(random);
    pile.push_back(placed(part, p_m, {a_rad, b_rad, turn_rad(random)}));
  }
  return pile;
}

}  // namespace graspd::testing
