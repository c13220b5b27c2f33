#pragma once

#include <string>
#include <vector>

#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/displacement.hpp"
#include "graspd/perception/scene.hpp"
#include "graspd/types/request.hpp"

/// Which objects of the last plan still stand: none where one has moved.
namespace graspd::perception {

/// The request's last plan, or nullptr where it has none, or where that is of other parts than are
/// asked for now: then `warnings` says so, and everything is planned anew.
const LastPlan* comparable_last_plan(const PlanRequest& request,
                                     std::vector<std::string>& warnings);

/// By what the readings say, where the scene has them on a grid and the parameters ask for it.
std::vector<StandingObject> standing_by_readings(const LastPlan* last_plan,
                                                 const PlanRequest& request, const Scene& scene,
                                                 const parts::Catalogue& catalogue,
                                                 const Parameters& parameters);

/// By the segments' centroids, in all other cases.
std::vector<StandingObject> standing_by_centroids(const LastPlan* last_plan,
                                                  const DepthFrame& frame,
                                                  const PlanRequest& request, const Scene& scene,
                                                  const std::vector<Indices>& segments,
                                                  const parts::Catalogue& catalogue,
                                                  const Parameters& parameters);

}  // namespace graspd::perception
