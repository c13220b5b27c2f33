#include "last_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "graspd/perception/segmentation.hpp"

namespace graspd::perception {
namespace {

bool compares_readings(const Scene& scene, const Parameters& parameters) {
  return scene.grid && parameters.displacement.check == DisplacementCheck::kReadings;
}

std::vector<Eigen::Vector3d> centroids_in_base(const Cloud& cloud,
                                               const std::vector<Indices>& segments,
                                               const Eigen::Isometry3d& T_base_camera) {
  std::vector<Eigen::Vector3d> centroids_m;
  for (const Indices& segment : segments) {
    centroids_m.push_back(T_base_camera * centroid_m(cloud, segment));
  }
  return centroids_m;
}

}  // namespace

const LastPlan* comparable_last_plan(const PlanRequest& request,
                                     std::vector<std::string>& warnings) {
  if (!request.last_plan) return nullptr;
  for (const LastObject& object : request.last_plan->objects) {
    if (std::ranges::find(request.parts, object.part_id, &RequestedPart::id) !=
        request.parts.end()) {
      continue;
    }
    warnings.push_back(
        fmt::format("last_plan: object {} is of part '{}', which is not asked for: everything is "
                    "planned anew; leave last_plan out where the parts change",
                    object.id, object.part_id));
    return nullptr;
  }
  return &*request.last_plan;
}

std::vector<StandingObject> standing_by_readings(const LastPlan* last_plan,
                                                 const PlanRequest& request, const Scene& scene,
                                                 const parts::Catalogue& catalogue,
                                                 const Parameters& parameters) {
  if (last_plan == nullptr || !compares_readings(scene, parameters)) return {};
  return standing_objects(*last_plan, catalogue, *scene.grid, request.T_base_camera.inverse(),
                          parameters)
      .value_or(std::vector<StandingObject>());
}

std::vector<StandingObject> standing_by_centroids(const LastPlan* last_plan,
                                                  const DepthFrame& frame,
                                                  const PlanRequest& request, const Scene& scene,
                                                  const std::vector<Indices>& segments,
                                                  const parts::Catalogue& catalogue,
                                                  const Parameters& parameters) {
  if (last_plan == nullptr || compares_readings(scene, parameters)) return {};
  const auto centroids_m = centroids_in_base(scene.cloud, segments, request.T_base_camera);
  const auto standing = unchanged_objects(*last_plan, centroids_m, parameters.displacement);
  if (!standing) return {};
  std::vector<StandingObject> objects;
  for (const LastObject& last : *standing) {
    const Eigen::Isometry3d T_camera_part = request.T_base_camera.inverse() * last.T_base_part;
    objects.push_back({last, evaluate_pose(frame, *catalogue.find(last.part_id), T_camera_part,
                                           parameters.registration.inlier_tolerance_m)});
  }
  return objects;
}

}  // namespace graspd::perception
