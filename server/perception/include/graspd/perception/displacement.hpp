#pragma once

#include <optional>
#include <span>
#include <vector>

#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/evidence.hpp"
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

/// An object that still stands, with what the new frame says of it.
struct StandingObject {
  LastObject last;
  Evidence evidence;
};

/// The same question, asked of the readings: no segment is needed, and none has to come out alike
/// in two frames. An object stayed if its last pose explains about as much of the frame as it did,
/// the camera sees through next to none of it, and no place `threshold_m` away explains more. What
/// newly hides an object counts as motion; what is newly seen of it does not, nor does an object
/// that comes to light: it is planned with the next full plan.
///
/// \param grid with parts marked; nothing else of it is read. \param catalogue knows all parts of
/// the last plan.
std::optional<std::vector<StandingObject>> standing_objects(const LastPlan& last_plan,
                                                            const parts::Catalogue& catalogue,
                                                            const DepthGrid& grid,
                                                            const Eigen::Isometry3d& T_camera_base,
                                                            const Parameters& parameters);

}  // namespace graspd::perception
