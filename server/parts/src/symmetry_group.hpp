#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::parts {

/// The largest finite group of a part: the icosahedron has 60 turns.
inline constexpr std::size_t kMaxGroupSize = 64;

/// All poses that products of the generators make, without the identity.
/// \returns INVALID_ARGUMENT where they make more than kMaxGroupSize.
Result<std::vector<Eigen::Isometry3d>> close_group(
    const std::vector<Eigen::Isometry3d>& generators);

}  // namespace graspd::parts
