#pragma once

#include <span>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/perception/placed_part.hpp"
#include "graspd/types/answer.hpp"

namespace graspd::perception {

/// Fills in what the answer says of the pile: each object's place in the graph, and its GRS.
/// \param parts of the objects, in their order.
void describe_pile(std::span<const PlacedPart> parts, const Parameters& parameters,
                   std::vector<Object>& objects);

}  // namespace graspd::perception
