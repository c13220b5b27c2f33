#include "graspd/perception/displacement.hpp"

#include <algorithm>

namespace graspd::perception {

std::optional<std::vector<LastObject>> unchanged_objects(
    const LastPlan& last_plan, std::span<const Eigen::Vector3d> centroids_base_m,
    const DisplacementParameters& parameters) {
  const auto is_seen = [&](const LastObject& object) {
    return std::any_of(centroids_base_m.begin(), centroids_base_m.end(), [&](const auto& centroid) {
      return (centroid - object.p_base_segment_centroid_m).norm() <= parameters.threshold_m;
    });
  };
  std::vector<LastObject> standing;
  for (const LastObject& object : last_plan.objects) {
    const bool picked = object.id == last_plan.picked_object_id;
    if (is_seen(object) == picked) return std::nullopt;
    if (!picked) standing.push_back(object);
  }
  if (standing.empty()) return std::nullopt;
  return standing;
}

}  // namespace graspd::perception
