#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graspd/perception/collision.hpp"
#include "graspd/perception/grasp_candidates.hpp"
#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// The grasp stage: for each part its candidates, best first, through the checks, until enough are
/// free. All in the floor's frame.
namespace graspd::perception {

/// A grasp with what every check says of it.
struct PlannedGrasp {
  std::string pick_point;
  Eigen::Isometry3d T_floor_grasp = Eigen::Isometry3d::Identity();
  double opening_width_m = 0;
  double room_m = 0;  ///< of a free one
  std::vector<CheckReport> checks;
};

/// What was found for one part.
struct PartGrasps {
  std::vector<PlannedGrasp> free;        ///< the preferred first
  std::optional<PlannedGrasp> rejected;  ///< where none is free: the preferred candidate
  /// A part that can't be lifted counts once, as kHeldPart.
  std::array<std::uint32_t, std::size(EnumNames<Check>::values)> rejected_by_check_n{};
};

/// \param ids of the parts, as reasons call them.
/// \param scene its target is set here.
/// \param explain_rejected whether `rejected` is wanted; it takes all checks of one more candidate.
PartGrasps plan_grasps_of(std::size_t target, std::span<const PlacedPart> parts,
                          std::span<const std::uint32_t> ids, const Gripper& gripper,
                          const GraspParameters& parameters, CollisionScene& scene,
                          bool explain_rejected);

}  // namespace graspd::perception
