#include "graspd/agent/pick_memory.hpp"

#include <algorithm>

namespace graspd::agent {

void PickMemory::placed(const PlanAnswer& answer, const Grasp& grasp) {
  std::erase_if(failed_spots_, [&](const FailedSpot& spot) { return is_near(spot, grasp); });
  last_plan_.reset();
  if (answer.objects.size() > kMaxLastObjects) return;
  LastPlan plan;
  plan.picked_object_id = grasp.object_id;
  for (const Object& object : answer.objects) {
    plan.objects.push_back({object.id, object.part_id, object.T_base_part,
                            object.p_base_segment_centroid_m, object.score,
                            object.visible_fraction});
  }
  last_plan_ = std::move(plan);
}

void PickMemory::failed(const Grasp& grasp) {
  last_plan_.reset();
  const auto spot = std::find_if(failed_spots_.begin(), failed_spots_.end(),
                                 [&](const FailedSpot& known) { return is_near(known, grasp); });
  if (spot != failed_spots_.end()) {
    ++spot->failures_n;
    return;
  }
  if (failed_spots_.size() == kMaxFailedSpots) failed_spots_.erase(failed_spots_.begin());
  failed_spots_.push_back({grasp.T_base_grasp.translation(), radius_m_, 1});
}

void PickMemory::add_to(PlanRequest& request) const {
  request.last_plan = last_plan_;
  request.failed_spots = failed_spots_;
}

bool PickMemory::is_near(const FailedSpot& spot, const Grasp& grasp) const {
  return (spot.p_base_m - grasp.T_base_grasp.translation()).norm() <= spot.radius_m;
}

}  // namespace graspd::agent
