#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <initializer_list>
#include <iterator>
#include <random>
#include <string>

#include "graspd/motion/arm_model.hpp"

namespace graspd::testing {

inline constexpr const char* kAnnoUrdf = GRASPD_SOURCE_DIR "/deploy/arms/probot_anno.urdf";

inline motion::ArmModel anno() { return motion::ArmModel::load(kAnnoUrdf).value(); }

/// The Anno's file, for tests that change something in it.
inline std::string anno_xml() {
  std::ifstream file(kAnnoUrdf);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline agent::Joints joints(std::initializer_list<double> q_rad) {
  return Eigen::Map<const Eigen::VectorXd>(q_rad.begin(), static_cast<Eigen::Index>(q_rad.size()));
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
