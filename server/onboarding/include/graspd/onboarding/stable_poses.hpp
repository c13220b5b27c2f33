#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspd/parts/part.hpp"

namespace graspd::onboarding {

/// A way in which the part lies on a table.
struct StablePose {
  Eigen::Vector3d down =
      -Eigen::Vector3d::UnitZ();  ///< unit, part frame: out of the part, into the table
  double height_m = 0;            ///< of the barycentre above the table
  double probability = 0;         ///< of coming to rest like this when set down turned at random
  double tip_rad = 0;             ///< by how much it may be tipped and still falls back
};

/// The faces of the convex hull above which the barycentre lies. A face is rested on as often as a
/// random turn has it below the barycentre (its solid angle from there, as Goldberg et al. 1999
/// have it), and those faces that it would tip off fall to the next one over. What is round rests
/// on any of many narrow faces: where a continuous symmetry turns them into each other they count
/// as one. Most probable first; their probabilities add up to 1, to a hundred-thousandth.
std::vector<StablePose> stable_poses(const parts::Part& part);

/// Which of the poses look alike, by the part's symmetries: indices into `poses`, most probable
/// group first.
std::vector<std::vector<std::size_t>> alike(const std::vector<StablePose>& poses,
                                            const parts::Part& part);

}  // namespace graspd::onboarding
