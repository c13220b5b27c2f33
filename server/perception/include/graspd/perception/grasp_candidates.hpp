#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string_view>
#include <vector>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/principal_axis.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// What a gripper could do with a part where it lies, in the floor's frame; nothing is checked yet.
struct GraspCandidate {
  std::string_view pick_point;  ///< kPrincipalAxis, or the name of the part's pick point
  /// z the approach into the part, x closing, origin between the finger tips or at the cup's seal.
  Eigen::Isometry3d T_floor_grasp = Eigen::Isometry3d::Identity();
  double width_m = 0;     ///< of the part between the jaws; of a cup's flat patch, across
  double preference = 0;  ///< priority, plus the cosine of the approach from the vertical
};

/// The grasps at the part's pick points, and for jaws the paper's on the principal axis, each with
/// its approach as near to vertical as its cone allows, and tilted about the closing direction. The
/// preferred ones first, at most `tries_per_part_n`, no two the same. An approach is at most
/// `max_tilt_rad` from the vertical; at a taught point whose cone allows no such,
/// `max_taught_tilt_rad`.
///
/// What jaws can't open to or close on, or a cup is too large for, is left out. Where nothing else
/// is left for jaws, what misses by least comes alone, so that the check of the opening says why.
std::vector<GraspCandidate> grasp_candidates(std::size_t target, std::span<const PlacedPart> parts,
                                             const Gripper& gripper,
                                             const GraspParameters& parameters);

}  // namespace graspd::perception
