#include "grasp_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "graspd/perception/grasp_planning.hpp"
#include "parallel.hpp"
#include "pile_objects.hpp"
#include "ranking.hpp"

namespace graspd::perception {
namespace {

Grasp grasp_of(const Object& object, const PlannedGrasp& planned,
               const Eigen::Isometry3d& T_base_floor, const Gripper& gripper) {
  Grasp grasp;
  grasp.object_id = object.id;
  grasp.pick_point = planned.pick_point;
  grasp.T_base_grasp = T_base_floor * planned.T_floor_grasp;
  grasp.opening_width_m = planned.opening_width_m;
  grasp.room_m = planned.room_m;
  grasp.standoff_m = gripper.standoff_m;
  grasp.retreat_m = gripper.retreat_m;
  grasp.checks = planned.checks;
  return grasp;
}

}  // namespace

void plan_grasps(const PlanRequest& request, const parts::Catalogue& catalogue,
                 const Parameters& parameters, const Scene& scene, PlanAnswer& answer) {
  answer.funnel.registered_n = static_cast<std::uint32_t>(answer.objects.size());
  const Eigen::Isometry3d T_base_floor = request.T_base_camera * scene.T_camera_floor;
  std::vector<PlacedPart> placed;
  std::vector<std::uint32_t> ids;
  for (const Object& object : answer.objects) {
    placed.push_back({catalogue.find(object.part_id), T_base_floor.inverse() * object.T_base_part,
                      object.score});
    ids.push_back(object.id);
  }
  // A target is taken out of its scene: each thread has one, and takes the objects in turn.
  std::vector<CollisionScene> scenes;
  parallel_invoke([&] { describe_pile(placed, parameters, answer.objects); },
                  [&] {
                    scenes.reserve(threads_n());
                    scenes.emplace_back(scene, placed, request.bin, request.gripper,
                                        parameters.collision);
                    while (scenes.size() < std::min(threads_n(), placed.size())) {
                      scenes.push_back(scenes.front());
                    }
                  });
  std::vector<PartGrasps> grasps_of(placed.size());
  parallel_for(scenes.size(), [&](std::size_t first) {
    for (std::size_t i = first; i < placed.size(); i += scenes.size()) {
      grasps_of[i] = plan_grasps_of(i, placed, ids, request.gripper, parameters.grasp,
                                    scenes[first], request.options.explain_rejected);
    }
  });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Object& object = answer.objects[i];
    const PartGrasps& planned = grasps_of[i];
    for (const PlannedGrasp& grasp : planned.free) {
      answer.grasps.push_back(grasp_of(object, grasp, T_base_floor, request.gripper));
    }
    if (planned.rejected) {
      answer.rejected_grasps.push_back(
          grasp_of(object, *planned.rejected, T_base_floor, request.gripper));
    }
    std::ranges::transform(planned.rejected_by_check_n, answer.funnel.rejected_by_check_n,
                           answer.funnel.rejected_by_check_n.begin(), std::plus());
  }
  if (answer.grasps.empty() && answer.rejected_grasps.empty() && !placed.empty()) {
    // Nobody asked why, but that there is no grasp needs a reason.
    const PartGrasps first = plan_grasps_of(0, placed, ids, request.gripper, parameters.grasp,
                                            scenes.front(), /*explain_rejected=*/true);
    answer.rejected_grasps.push_back(
        grasp_of(answer.objects[0], *first.rejected, T_base_floor, request.gripper));
  }
  rank_grasps(request, parameters, answer.objects, answer.grasps);
  const auto most = static_cast<std::size_t>(parameters.grasp.max_grasps_n);
  if (answer.grasps.size() > most) answer.grasps.resize(most);
  answer.funnel.grasps_n = static_cast<std::uint32_t>(answer.grasps.size());
}

void forget_objects(PlanAnswer& answer) {
  answer.objects.clear();
  answer.rejected_grasps.clear();
  answer.funnel.rejected_by_check_n = {};
}

void conclude(PlanAnswer& answer, const PlanOptions& options, bool is_unchanged,
              const Parameters& parameters) {
  const std::string failure = first_failure(answer.rejected_grasps);
  if (!options.explain_rejected) answer.rejected_grasps.clear();
  if (answer.grasps.empty()) {
    answer.outcome = Outcome::kAllInCollision;
    answer.reason = fmt::format("every grasp fails a check; the first: {}", failure);
  } else if (is_unchanged) {
    answer.outcome = Outcome::kUnchanged;
    answer.reason = fmt::format("no object moved by more than {:.1f} mm since the last plan",
                                parameters.displacement.threshold_m * 1e3);
  }
}

}  // namespace graspd::perception
