#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh_geometry.hpp"

namespace graspd::parts {

/// A direction through the barycentre about which the part may be symmetric.
struct CandidateAxis {
  Eigen::Vector3d direction;
  double uncertainty_rad;  ///< of the direction
};

struct CandidateAxes {
  std::vector<CandidateAxis> axes;
  /// Half turns across the main axis: one that holds, and the turns about that axis, make the rest.
  std::vector<CandidateAxis> across;
};

/// Where the axes of symmetry can be, from the inertia of the surface. Three distinct moments: the
/// principal axes. Two alike: turns across the third principal axis as well, in all directions. All
/// alike: where the higher moments are stationary.
/// \param triangles of the surface, about its barycentre, none longer than a fifth of it.
/// \param principal_axes as columns, the longest extent first.
/// \param alike_m standard deviations that differ by less say nothing about directions.
CandidateAxes candidate_axes(const std::vector<Triangle>& triangles,
                             const Eigen::Matrix3d& principal_axes, double alike_m);

}  // namespace graspd::parts
