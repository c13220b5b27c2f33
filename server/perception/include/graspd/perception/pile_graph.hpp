#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graspd/perception/parameters.hpp"
#include "graspd/perception/placed_part.hpp"

namespace graspd::perception {

/// Who lies on whom, told from the poses of the registered parts alone. Each list is one part's;
/// indices are those of the parts given, ascending.
///
/// - `lies_on`: the surfaces touch, and the one below bears a share of the other's weight. Nothing
///   lies on itself, not even by way of others: of a ring of parts that each lie on the next, the
///   edge that bears least is taken for entanglement instead.
/// - `entangled_with`: each of the two is over the other, as where a pipe runs through a ring or
/// two
///   hooks hold each other: neither is lifted straight up without the other.
/// - `double_picks`: parts that lie over this one, touching or not, so far that a lift straight up
///   may take them along.
///
/// It does not know what was not registered: a part may bear one that is not in the list.
struct PileGraph {
  std::vector<std::vector<std::uint32_t>> lies_on, supports, entangled_with, double_picks;
  std::vector<double> load;   ///< weight that rests on it, directly or through others, in parts
  std::vector<double> cover;  ///< how much of other parts lies over it, each as a share of the part

  /// Nothing rests on it, holds it or would come along.
  bool is_free(std::size_t part) const {
    return supports[part].empty() && entangled_with[part].empty() && double_picks[part].empty();
  }
};

/// Deterministic. \param parts in the floor's frame; the floor is at z = 0.
PileGraph make_pile_graph(std::span<const PlacedPart> parts, const PileParameters& parameters);

}  // namespace graspd::perception
