#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string_view>
#include <vector>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// What a gripper could do with one part, in the floor's frame; nothing is checked yet.
struct GraspCandidate {
  std::string_view pick_point;  ///< where on the part, by name
  /// z the approach direction, into the part; x the closing direction; origin between the tips.
  Eigen::Isometry3d T_floor_grasp = Eigen::Isometry3d::Identity();
  double width_m = 0;     ///< of the part between the jaws
  double preference = 0;  ///< higher first
};

/// x̃ = arg min k₃·de(x) + k₄·dn(x) over the principal axis (the paper, eq. 10); de(x) the distance
/// to the barycentre, dn(x) to the nearest template point of another part.
/// \returns the point on the axis. Alone in the bin, a part is grasped at its barycentre.
Eigen::Vector3d grasp_point(std::size_t target, std::span<const PlacedPart> parts,
                            const GraspParameters& parameters);

/// The grasps at `grasp_point`, best first: closing direction across the principal axis, approach
/// from the vertical outwards. Those with nothing between the jaws are left out.
std::vector<GraspCandidate> grasp_candidates(std::size_t target, std::span<const PlacedPart> parts,
                                             const Gripper& gripper,
                                             const GraspParameters& parameters);

}  // namespace graspd::perception
