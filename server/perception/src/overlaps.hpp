#pragma once

#include <span>

#include "graspd/perception/placed_part.hpp"
#include "pairs.hpp"

namespace graspd::perception {

/// In how many vertical columns one part is over another: (upper, lower). (i, i) is the number of
/// columns that part i has. Both (a, b) and (b, a) may be above 0.
/// \param tolerance_m by which a part that is over another may be below its surface.
Pairs<int> find_overlaps(std::span<const PlacedPart> parts, double tolerance_m);

}  // namespace graspd::perception
