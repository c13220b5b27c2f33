#pragma once

#include <Eigen/Geometry>

#include "graspd/perception/depth_grid.hpp"

namespace graspd::perception {

/// A time-of-flight camera sees all that lies in a bin bend up towards the walls, since light also
/// comes to it by way of them: by bow_m · (1 − d / reach_m)² at the distance d from the nearest
/// wall.
struct BowedWalls {
  Eigen::Isometry3f T_bin_camera = Eigen::Isometry3f::Identity();
  Eigen::Array2f half_size_m = Eigen::Array2f::Zero();
  float reach_m = 0;

  /// Of the bow, what a reading here is bent by, in [0, 1]; 0 outside the walls.
  float share_at(const Eigen::Vector3f& p_camera_m) const;
};
/// The walls of this bin, made ready to be asked.
BowedWalls bowed_walls(const Eigen::Isometry3d& T_camera_bin, const Eigen::Vector3d& inner_size_m,
                       double reach_m);

/// Takes a bow out of the readings; nothing else of the grid changes.
void straighten(DepthGrid& grid, const BowedWalls& walls, double bow_m);

}  // namespace graspd::perception
