#pragma once

#include <gtest/gtest.h>

#include <random>

#include "graspd/motion/arm_model.hpp"

namespace graspd::testing {

inline motion::ArmModel anno() {
  return motion::ArmModel::load(GRASPD_SOURCE_DIR "/deploy/arms/probot_anno.urdf").value();
}

/// Anywhere within the limits.
inline agent::Joints random_joints(std::mt19937& random, const motion::ArmModel& arm) {
  agent::Joints q_rad(arm.joints_n());
  for (int j = 0; j < q_rad.size(); ++j) {
    const motion::JointLimits& limits = arm.limits()[static_cast<std::size_t>(j)];
    q_rad[j] = std::uniform_real_distribution<double>(limits.min_rad, limits.max_rad)(random);
  }
  return q_rad;
}

inline double turn_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

}  // namespace graspd::testing
