#pragma once

#include <span>

#include "graspd/perception/bowed_walls.hpp"
#include "graspd/perception/pose_hypothesis.hpp"

namespace graspd::perception {

/// By how much more than it is already straightened an image is bowed. A full bin hides its floor,
/// but parts show the bow too: what is bent fits no pose. It is the one unknown that all parts have
/// in common, beside six for the pose of each, in the normal equations of projective ICP. The poses
/// need not be right: wrong ones pull now this way, now that.
/// \param poses roughly placed, best first.
/// \returns less than the bow, the less the parts say: 0 where none lies near the walls. Ask again
/// with a straightened image where it is much.
double find_wall_bow_m(const DepthGrid& grid, const PoseVerifier& verifier,
                       std::span<const PoseHypothesis> poses, const BowedWalls& walls);

}  // namespace graspd::perception
