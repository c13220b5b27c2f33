#pragma once

#include <algorithm>

#include "contact_kernel.hpp"
#include "graspd/perception/placed_part.hpp"
#include "kernel_pose.hpp"

/// Where two parts are near to each other. Internal to perception.
namespace graspd::perception {

/// A template point of one part, and one of the other part that is near to it; both in the other's
/// frame.
struct NearPoints {
  std::uint32_t index;  ///< in the first part's contact.points()
  Eigen::Vector3f p_m, normal;
  const parts::SurfacePoint& other;
};

/// Calls `visit(index)` for the spheres, from `first` on, that may be within `distance_m` of the
/// grid's template.
template <class Visit>
void visit_spheres_near(const parts::SphereArrays& spheres, std::uint32_t first,
                        std::uint32_t spheres_n, const KernelPose& T_grid_sphere,
                        const DistanceSpan& grid, float distance_m, Visit visit) {
  SphereIndices near;
  const std::uint32_t end = first + spheres_n;
  for (; first < end; first += SphereIndices::kMost) {
    const SphereSpan span{spheres.x_m.data(),
                          spheres.y_m.data(),
                          spheres.z_m.data(),
                          spheres.radius_m.data(),
                          first,
                          std::min(SphereIndices::kMost, end - first)};
    const std::size_t near_n = find_spheres_near(span, T_grid_sphere, grid, distance_m, near);
    for (std::size_t k = 0; k < near_n; ++k) visit(near.values[k]);
  }
}

inline DistanceSpan span_of(const parts::DistanceGrid& grid) {
  return {grid.distance_m.data(),
          {grid.origin_m.x(), grid.origin_m.y(), grid.origin_m.z()},
          {grid.size.x(), grid.size.y(), grid.size.z()},
          grid.cells_per_m};
}

/// Calls `visit(NearPoints)` for each template point of `part` within `distance_m` ≤
/// ContactModel::kMaxDistance_m of one of `other`.
template <class Visit>
void visit_near_points(const PlacedPart& part, const PlacedPart& other, double distance_m,
                       Visit visit) {
  const double reach_m = part.part->radius_m + other.part->radius_m + distance_m;
  const Eigen::Vector3d between_m = part.barycentre_m() - other.barycentre_m();
  if (between_m.squaredNorm() > reach_m * reach_m) return;
  const parts::ContactModel& moved = part.part->contact;
  const parts::ContactModel& model = other.part->contact;
  if (moved.points().empty() || model.points().empty()) return;
  const Eigen::Isometry3d T_other_part = other.T_floor_part.inverse() * part.T_floor_part;
  const Eigen::Matrix3f R = T_other_part.linear().cast<float>();
  const Eigen::Vector3f t_m = T_other_part.translation().cast<float>();
  const KernelPose pose = kernel_pose(T_other_part);
  const DistanceSpan grid = span_of(model.grid());
  const auto near_m = static_cast<float>(distance_m);

  const auto visit_point = [&](std::uint32_t i) {
    const parts::SurfacePoint& point = moved.points()[i];
    const Eigen::Vector3f p_m = R * point.position_m + t_m;
    const parts::SurfacePoint* near = model.find_within(p_m, near_m);
    if (near != nullptr) visit(NearPoints{i, p_m, R * point.normal, *near});
  };
  const auto visit_patch = [&](std::uint32_t i) {
    const parts::Patch& patch = moved.patches()[i];
    visit_spheres_near(moved.point_spheres(), patch.first, patch.points_n, pose, grid, near_m,
                       visit_point);
  };
  visit_spheres_near(moved.patch_spheres(), 0, static_cast<std::uint32_t>(moved.patches().size()),
                     pose, grid, near_m, visit_patch);
}

}  // namespace graspd::perception
