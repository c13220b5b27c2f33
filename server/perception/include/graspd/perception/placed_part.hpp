#pragma once

#include <Eigen/Geometry>

#include "graspd/parts/part.hpp"

namespace graspd::perception {

/// A part where it lies. The frame is the bin's: z up, origin on the floor.
struct PlacedPart {
  const parts::Part* part = nullptr;
  Eigen::Isometry3d T_floor_part = Eigen::Isometry3d::Identity();
  double score = 1;  ///< of its registration, in [0, 1]

  Eigen::Vector3d barycentre_m() const { return T_floor_part * part->barycentre_m; }
  /// Of the longest principal axis, either way round.
  Eigen::Vector3d principal_axis() const {
    return T_floor_part.linear() * part->principal_axes.col(0);
  }
};

}  // namespace graspd::perception
