#pragma once

#include <string>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// Best first: spots that failed come last, then higher part priorities first, then the request's
/// strategy. GRS decides among equals, and by default alone.
void rank_grasps(const PlanRequest& request, const Parameters& parameters,
                 const std::vector<Object>& objects, std::vector<Grasp>& grasps);

/// "opening: the part is …", of the first grasp that has one.
std::string first_failure(const std::vector<Grasp>& rejected);

}  // namespace graspd::perception
