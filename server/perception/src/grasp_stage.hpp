#pragma once

#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/scene.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// The last stage of a plan: from the answer's objects to its grasps and its outcome. Internal to
/// perception.
namespace graspd::perception {

/// GRS of every object, then its grasps, checked and ranked.
void plan_grasps(const PlanRequest& request, const parts::Catalogue& catalogue,
                 const Parameters& parameters, const Scene& scene, PlanAnswer& answer);

/// Undoes plan_grasps that found no grasp, and takes its objects out of the answer.
void forget_objects(PlanAnswer& answer);

/// The outcome of a plan that has objects.
void conclude(PlanAnswer& answer, const PlanOptions& options, bool is_unchanged,
              const Parameters& parameters);

}  // namespace graspd::perception
