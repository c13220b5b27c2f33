#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::parts {

/// The largest finite group of a part: a gear of 60 teeth that may be turned over. The icosahedron
/// has 60 turns.
inline constexpr std::size_t kMaxGroupSize = 120;
/// Loose enough that 51.43 written for 360/7 closes after 7 turns; far below the least turn of a
/// group of kMaxGroupSize.
inline constexpr double kTypedAngle_rad = 2e-3;

/// All poses that products of the generators make, without the identity.
/// \param same_angle_rad poses turned against each other by less are one.
/// \returns INVALID_ARGUMENT where they make more than kMaxGroupSize.
Result<std::vector<Eigen::Isometry3d>> close_group(const std::vector<Eigen::Isometry3d>& generators,
                                                   double same_angle_rad = kTypedAngle_rad);

/// Turns about the origin that are nearly a group without its identity, as `close_group` makes them
/// of measured generators, become one to the last digits.
void make_exact(std::vector<Eigen::Isometry3d>& group);

}  // namespace graspd::parts
