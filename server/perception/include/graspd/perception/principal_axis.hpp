#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string_view>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/request.hpp"

/// Where the paper grasps a part (III-D.2). All in the floor's frame.
namespace graspd::perception {

inline constexpr std::string_view kPrincipalAxis = "principal_axis";

/// x̃ = arg min k₃·de(x) + k₄·dn(x) over the principal axis (eq. 10); de(x) the distance to the
/// barycentre, dn(x) to the nearest template point of another part.
/// \returns the point on the axis. Alone in the bin, a part is grasped at its barycentre.
Eigen::Vector3d grasp_point(std::size_t target, std::span<const PlacedPart> parts,
                            const GraspParameters& parameters);

/// Across the principal axis, in the horizontal plane; across the second axis where the first
/// stands upright.
Eigen::Vector3d closing_direction(const PlacedPart& part);

/// How wide the part is between the jaws: the extent along x of the template points that lie
/// between them. \returns nothing where there are none.
std::optional<double> width_between_jaws_m(const PlacedPart& part,
                                           const Eigen::Isometry3d& T_floor_grasp,
                                           const Gripper& gripper);

}  // namespace graspd::perception
