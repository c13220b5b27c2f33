#pragma once

#include <Eigen/Geometry>
#include <random>

namespace graspd::testing {

inline Eigen::Vector3f random_point(std::mt19937& random, float side_m) {
  std::uniform_real_distribution<float> uniform(-side_m / 2, side_m / 2);
  const float x = uniform(random);
  const float y = uniform(random);
  return {x, y, uniform(random)};
}

inline Eigen::Quaterniond random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random);
  const double x = normal(random);
  const double y = normal(random);
  return Eigen::Quaterniond(w, x, y, normal(random)).normalized();
}

/// Any turn, within a cube about the origin.
inline Eigen::Isometry3d random_pose(std::mt19937& random, double side_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(random_point(random, static_cast<float>(side_m)).cast<double>());
  T.rotate(random_rotation(random));
  return T;
}

}  // namespace graspd::testing
