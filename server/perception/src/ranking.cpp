#include "ranking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <unordered_map>

#include "graspd/perception/grs.hpp"
#include "graspd/perception/principal_axis.hpp"

namespace graspd::perception {
namespace {

std::uint32_t failures_at(const Grasp& grasp, const std::vector<FailedSpot>& spots) {
  std::uint32_t failures_n = 0;
  for (const FailedSpot& spot : spots) {
    const double distance_m = (grasp.T_base_grasp.translation() - spot.p_base_m).norm();
    if (distance_m <= spot.radius_m) failures_n += spot.failures_n;
  }
  return failures_n;
}

double priority_of(const Object& object, const PlanRequest& request) {
  const auto requested =
      std::find_if(request.parts.begin(), request.parts.end(),
                   [&](const RequestedPart& part) { return part.id == object.part_id; });
  return requested == request.parts.end() ? 0 : requested->priority;
}

/// What the strategy prefers, larger first; nothing for GRS.
std::optional<double> preference(const Grasp& grasp, const Object& object,
                                 const PlanOptions& options) {
  switch (options.strategy) {
    case Strategy::kHighest:
      return object.grs.height_m;
    case Strategy::kMostVisible:
      return object.visible_fraction;
    case Strategy::kNearest:
      return -(grasp.T_base_grasp.translation() - options.strategy_vector_base_m).norm();
    case Strategy::kPreferredApproach:
      return grasp.T_base_grasp.linear().col(2).dot(options.strategy_vector_base_m.normalized());
    case Strategy::kGrs:
    case Strategy::kServerDefault:
      break;
  }
  return std::nullopt;
}

/// How many layers of parts lie on each object, by id. Nothing lies on itself, so that this ends.
class Layers {
 public:
  explicit Layers(const std::vector<Object>& objects) {
    for (const Object& object : objects) objects_[object.id] = &object;
  }
  int of(const Object& object) {
    if (const auto known = layers_.find(object.id); known != layers_.end()) return known->second;
    int layer = object.entangled_ids.empty() && object.double_pick_ids.empty() ? 0 : 1;
    for (const std::uint32_t id : object.supports_ids) {
      layer = std::max(layer, 1 + of(*objects_.at(id)));
    }
    return layers_[object.id] = layer;
  }

 private:
  std::unordered_map<std::uint32_t, const Object*> objects_;
  std::unordered_map<std::uint32_t, int> layers_;
};

struct Ranked {
  Grasp grasp;
  const Object* object = nullptr;
  std::uint32_t failures_n = 0, object_failures_n = 0;
  int layer = 0;
  bool is_last_resort = false;
  bool is_doubtful = false;
  double room_m = 0;
  double priority = 0;
  std::optional<double> preference;
  std::size_t turn = 0;  ///< 0 for the best grasp of its object, 1 for its next …
};

std::vector<Ranked> with_objects(const PlanRequest& request, const GrsParameters& parameters,
                                 const std::vector<Object>& objects, std::vector<Grasp>& grasps) {
  // Otherwise the order is the paper's.
  const bool is_ours =
      parameters.p_system == PSystem::kSupport && parameters.order == GraspOrder::kDescending;
  Layers layers(objects);
  std::vector<Ranked> ranked;
  for (Grasp& grasp : grasps) {
    const auto object = std::ranges::find(objects, grasp.object_id, &Object::id);
    const auto preferred = preference(grasp, *object, request.options);
    grasp.score = preferred.value_or(object->grs.grs);
    const std::uint32_t failures_n = failures_at(grasp, request.failed_spots);
    const int layer = is_ours ? layers.of(*object) : 0;
    const bool by_risk = is_ours && !preferred;
    const bool is_last_resort = by_risk && grasp.pick_point == kPrincipalAxis;
    const bool is_doubtful = by_risk && object->score < parameters.sure_score;
    const double room_m = by_risk ? grasp.room_m : 0;
    ranked.push_back({std::move(grasp), &*object, failures_n, 0, layer, is_last_resort, is_doubtful,
                      room_m, priority_of(*object, request), preferred});
  }
  return ranked;
}

/// Object by object: what failed at any of its grasps, and which of them is tried first.
void take_turns(std::vector<Ranked>& ranked) {
  std::ranges::stable_sort(ranked, [](const Ranked& a, const Ranked& b) {
    if (a.object != b.object) return a.object->id < b.object->id;
    if (a.failures_n != b.failures_n) return a.failures_n < b.failures_n;
    if (a.is_last_resort != b.is_last_resort) return b.is_last_resort;
    if (a.room_m != b.room_m) return a.room_m > b.room_m;
    return a.preference > b.preference;
  });
  for (auto first = ranked.begin(); first != ranked.end();) {
    const auto last = std::find_if(
        first, ranked.end(), [&](const Ranked& other) { return other.object != first->object; });
    std::size_t turn = 0;
    const std::uint32_t object_failures_n = std::prev(last)->failures_n;
    for (; first != last; ++first) {
      first->turn = turn++;
      first->object_failures_n = object_failures_n;
    }
  }
}

}  // namespace

void rank_grasps(const PlanRequest& request, const Parameters& parameters,
                 const std::vector<Object>& objects, std::vector<Grasp>& grasps) {
  std::vector<Ranked> ranked = with_objects(request, parameters.grs, objects, grasps);
  take_turns(ranked);
  // What take_turns left, by id, decides among equals.
  std::ranges::stable_sort(ranked, [&](const Ranked& a, const Ranked& b) {
    if (a.failures_n != b.failures_n) return a.failures_n < b.failures_n;
    if (a.object_failures_n != b.object_failures_n) {
      return a.object_failures_n < b.object_failures_n;
    }
    if (a.layer != b.layer) return a.layer < b.layer;
    if (a.priority != b.priority) return a.priority > b.priority;
    if (a.is_last_resort != b.is_last_resort) return b.is_last_resort;
    if (a.is_doubtful != b.is_doubtful) return b.is_doubtful;
    if (a.turn != b.turn) return a.turn < b.turn;
    if (a.room_m != b.room_m) return a.room_m > b.room_m;
    if (a.preference != b.preference) return a.preference > b.preference;
    return ranks_before(a.object->grs, b.object->grs, parameters.grs);
  });
  grasps.clear();
  for (Ranked& entry : ranked) grasps.push_back(std::move(entry.grasp));
}

std::string first_failure(const std::vector<Grasp>& rejected) {
  for (const Grasp& grasp : rejected) {
    for (const CheckReport& check : grasp.checks) {
      if (check.state == CheckState::kFailed) {
        return fmt::format("{}: {}", name_of(check.check), check.reason);
      }
    }
  }
  return {};
}

}  // namespace graspd::perception
