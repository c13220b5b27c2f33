#include "graspd/agent/pick_memory.hpp"

#include <algorithm>

namespace graspd::agent {
namespace {

/// Another grasp at the same spot, from another side, may be within reach.
constexpr double kPassedOverRadius_m = 0.005;
constexpr std::size_t kMaxReason_bytes = 128;

/// What a request may carry: no control characters, whole UTF-8 characters.
std::string short_reason(std::string_view reason) {
  std::string text(reason.substr(0, kMaxReason_bytes));
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
  if (reason.size() > text.size() && continues(reason[text.size()])) {
    while (continues(text.back())) text.pop_back();
    text.pop_back();
  }
  const auto is_control = [](char c) { return (c >= 0 && c < 0x20) || c == 0x7f; };
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

}  // namespace

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
  failed_spots_.push_back({grasp.T_base_grasp.translation(), radius_m_, 1, {}});
}

void PickMemory::passed_over(const Grasp& grasp, std::string_view reason) {
  passed_over_.push_back(
      {grasp.T_base_grasp.translation(), kPassedOverRadius_m, 1, short_reason(reason)});
}

void PickMemory::add_to(PlanRequest& request) const {
  request.last_plan = last_plan_;
  request.failed_spots = failed_spots_;
  const auto room_n = std::min(kMaxFailedSpots - failed_spots_.size(), passed_over_.size());
  std::copy_n(passed_over_.begin(), room_n, std::back_inserter(request.failed_spots));
}

bool PickMemory::is_near(const FailedSpot& spot, const Grasp& grasp) const {
  return (spot.p_base_m - grasp.T_base_grasp.translation()).norm() <= spot.radius_m;
}

}  // namespace graspd::agent
