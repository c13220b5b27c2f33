#pragma once

#include <optional>
#include <span>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// The paper's displacement check: did the objects of the last plan, the picked one aside, stay
/// where they were? An object stayed if some segment's centroid lies within `threshold_m` of the
/// centroid its segment had.
///
/// \param centroids_base_m of the new frame's segments, in base.
/// \returns the objects that still stand, in their old order, where all of them stayed; nothing
/// where one has moved, where there is none left, or where the picked object is still seen.
std::optional<std::vector<LastObject>> unchanged_objects(
    const LastPlan& last_plan, std::span<const Eigen::Vector3d> centroids_base_m,
    const DisplacementParameters& parameters);

}  // namespace graspd::perception
