#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "random_pose.hpp"

namespace graspd::testing {

/// Clumps of points among scattered ones: dense and thin places, and points on top of each other.
inline perception::Cloud clumpy_cloud(std::mt19937& random, std::size_t count) {
  std::normal_distribution<float> near(0, 0.004f);
  std::vector<Eigen::Vector3f> centres;
  for (int i = 0; i < 8; ++i) centres.push_back(random_point(random, 0.1f));
  perception::Cloud cloud;
  while (cloud.size() < count) {
    const std::size_t kind = random() % 10;
    if (kind == 0) {
      cloud.points_m.push_back(random_point(random, 0.12f));
    } else if (kind == 1 && !cloud.empty()) {
      cloud.points_m.push_back(cloud.points_m[random() % cloud.size()]);
    } else {
      const float x = near(random);
      const float y = near(random);
      cloud.points_m.push_back(centres[random() % centres.size()] +
                               Eigen::Vector3f(x, y, near(random)));
    }
  }
  return cloud;
}

}  // namespace graspd::testing
