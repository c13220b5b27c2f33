#pragma once

#include "graspd/perception/placed_part.hpp"

/// Where two parts are near to each other. Internal to perception.
namespace graspd::perception {

/// A template point of one part, and one of the other part that is near to it; both in the other's
/// frame.
struct NearPoints {
  std::uint32_t index;  ///< in the first part's contact.points()
  Eigen::Vector3f p_m, normal;
  const parts::SurfacePoint& other;
};

/// Calls `visit(NearPoints)` for each template point of `part` within `distance_m` ≤
/// ContactModel::kMaxDistance_m of one of `other`.
template <class Visit>
void visit_near_points(const PlacedPart& part, const PlacedPart& other, double distance_m,
                       Visit visit) {
  const double reach_m = other.part->radius_m + distance_m;
  const double between_m = (part.barycentre_m() - other.barycentre_m()).norm();
  if (between_m > part.part->radius_m + reach_m) return;
  const Eigen::Isometry3f T_other_part =
      (other.T_floor_part.inverse() * part.T_floor_part).cast<float>();
  const Eigen::Matrix3f R = T_other_part.linear();
  const Eigen::Vector3f t_m = T_other_part.translation();
  const Eigen::Vector3f p_part_other_m =
      (part.T_floor_part.inverse() * other.barycentre_m()).cast<float>();
  const auto near_m = static_cast<float>(distance_m);

  const parts::ContactModel& model = other.part->contact;
  const auto& points = part.part->contact.points();
  for (const parts::Patch& patch : part.part->contact.patches()) {
    const float patch_reach_m = static_cast<float>(reach_m) + patch.radius_m;
    const float distance2_m2 = (patch.centre_m - p_part_other_m).squaredNorm();
    if (distance2_m2 > patch_reach_m * patch_reach_m) continue;
    if (!model.may_touch(R * patch.centre_m + t_m, patch.radius_m, near_m)) continue;
    for (std::uint32_t i = patch.first; i < patch.first + patch.points_n; ++i) {
      const Eigen::Vector3f p_m = R * points[i].position_m + t_m;
      const parts::SurfacePoint* near = model.find_within(p_m, near_m);
      if (near != nullptr) visit(NearPoints{i, p_m, R * points[i].normal, *near});
    }
  }
}

}  // namespace graspd::perception
