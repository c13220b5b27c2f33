#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/principal_axis.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// Grasp position, angle and opening width (the paper, III-D.2). All in the floor's frame: z up,
/// origin on the floor, where a bin is given at its centre.
namespace graspd::perception {

/// Whether jaws and palm stay inside the bin's walls and above its floor.
bool gripper_inside_bin(const Eigen::Isometry3d& T_floor_grasp, double opening_width_m,
                        const Gripper& gripper, const Eigen::Vector3d& bin_inner_size_m);

/// A grasp in the floor's frame, with the checks that ran.
struct PlannedGrasp {
  Eigen::Isometry3d T_floor_grasp = Eigen::Isometry3d::Identity();
  double opening_width_m = 0;
  std::vector<CheckReport> checks;

  bool is_free() const;
};

/// The grasp at `grasp_point`: closing direction across the principal axis, approach as near to
/// vertical as the bin's walls allow, opening the part's width there plus the clearance.
/// \param bin_inner_size_m where a bin is given.
PlannedGrasp plan_grasp(std::size_t target, std::span<const PlacedPart> parts,
                        const std::optional<Eigen::Vector3d>& bin_inner_size_m,
                        const Gripper& gripper, const GraspParameters& parameters);

}  // namespace graspd::perception
