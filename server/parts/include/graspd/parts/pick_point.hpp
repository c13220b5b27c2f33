#pragma once

#include <Eigen/Core>
#include <string>

namespace graspd::parts {

/// A place to grasp, in the part frame: taught in the part file, or proposed from the mesh.
struct PickPoint {
  std::string name;  ///< its images under the part's symmetries share it
  /// Between jaws the middle of the line on which they close; for a cup where its seal sits.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();  ///< unit, into the part
  Eigen::Vector3d closing = Eigen::Vector3d::UnitX();    ///< unit, jaw to jaw
  double approach_cone_rad = 0.5;  ///< by which the approach may turn about `closing` either way
  double tip_reach_m = 0;          ///< of the finger tips beyond the position, along the approach
  double width_m = 0;              ///< of the part between the jaws; of a cup's flat patch, across
  double priority = 0;
  std::string gripper;  ///< kind it is for; empty: any
  bool is_proposed = false;
};

}  // namespace graspd::parts
