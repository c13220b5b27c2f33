#include "ranking.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "graspd/perception/grs.hpp"

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

/// What the strategy prefers, larger first; 0 for GRS, which decides below.
double preference(const Grasp& grasp, const Object& object, const PlanOptions& options) {
  switch (options.strategy) {
    case Strategy::kHighest:
      return object.grs.height_m;
    case Strategy::kMostVisible:
      return object.visible_fraction;
    case Strategy::kNearest:
      return -(grasp.T_base_grasp.translation() - options.strategy_vector_base_m).norm();
    case Strategy::kPreferredApproach:
      return grasp.T_base_grasp.linear().col(2).dot(options.strategy_vector_base_m);
    case Strategy::kGrs:
    case Strategy::kServerDefault:
      break;
  }
  return 0;
}

}  // namespace

void rank_grasps(const PlanRequest& request, const Parameters& parameters,
                 const std::vector<Object>& objects, std::vector<Grasp>& grasps) {
  struct Ranked {
    Grasp grasp;
    const Object* object;
    std::uint32_t failures_n;
    double priority;
    double preference;
  };
  std::vector<Ranked> ranked;
  for (Grasp& grasp : grasps) {
    const auto object = std::find_if(objects.begin(), objects.end(), [&](const Object& candidate) {
      return candidate.id == grasp.object_id;
    });
    const std::uint32_t failures_n = failures_at(grasp, request.failed_spots);
    const double preferred = preference(grasp, *object, request.options);
    ranked.push_back(
        {std::move(grasp), &*object, failures_n, priority_of(*object, request), preferred});
  }
  std::stable_sort(ranked.begin(), ranked.end(), [&](const Ranked& a, const Ranked& b) {
    if (a.failures_n != b.failures_n) return a.failures_n < b.failures_n;
    if (a.priority != b.priority) return a.priority > b.priority;
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
