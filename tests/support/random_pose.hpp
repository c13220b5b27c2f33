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

}  // namespace graspd::testing
