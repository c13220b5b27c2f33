#pragma once

#include <kdl/segment.hpp>
#include <string>
#include <vector>

#include "graspd/motion/arm_model.hpp"

namespace graspd::motion {

/// The tree of links in Orocos KDL's terms: one segment a link, from the parent's frame to its own.
struct ArmData {
  std::string name;
  std::vector<JointLimits> limits;
  std::vector<LinkShape> links;
  // As `links`.
  std::vector<KDL::Segment> segments;
  std::vector<int> parents;  ///< -1: the root
  std::vector<int> joints;   ///< the one that turns the segment; -1: none
  int flange = 0;
};

inline Eigen::Isometry3d to_eigen(const KDL::Frame& frame) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(frame.M.data);
  T.translation() = Eigen::Map<const Eigen::Vector3d>(frame.p.data);
  return T;
}

}  // namespace graspd::motion
