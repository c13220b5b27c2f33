#pragma once

#include <string>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// Sorts grasps, best first, for an agent that tries one after the other. What comes first in this
/// list decides, what follows decides among equals:
///
/// 1. Fewer failures at the grasp's own spot, then fewer at any spot of its object.
/// 2. Layer by layer from the top: objects that nothing rests on, holds or would come along with,
///    then what only those rest on, and so on, so that nothing comes before what rests on it. Only
///    with P_system `support` and order `descending`: else the order is the paper's own.
/// 3. The higher part priority.
/// 4. An object's first grasp before any other object's second: after a grasp has failed, another
///    of the same object is worth less than the next object. An object's own grasps keep the order
///    they come in, but for the strategy.
/// 5. The request's strategy: height, visible fraction, nearness, approach; by default GRS alone.
/// 6. GRS, and where P_system makes scores equal, α·P_self + β·P_grasp.
/// 7. The object's id.
///
/// Sets each grasp's score: by the strategy, or else GRS.
void rank_grasps(const PlanRequest& request, const Parameters& parameters,
                 const std::vector<Object>& objects, std::vector<Grasp>& grasps);

/// "opening: the part is …", of the first grasp that has one.
std::string first_failure(const std::vector<Grasp>& rejected);

}  // namespace graspd::perception
