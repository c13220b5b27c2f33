#include "pile_objects.hpp"

#include "graspd/perception/grs.hpp"
#include "graspd/perception/pile_graph.hpp"

namespace graspd::perception {

void describe_pile(std::span<const PlacedPart> parts, const Parameters& parameters,
                   std::vector<Object>& objects) {
  const PileGraph graph = make_pile_graph(parts, parameters.pile);
  const std::vector<GrsTerms> scores = grasp_risk_scores(parts, graph, parameters.grs);
  const auto ids = [&](std::vector<std::uint32_t> indices) {
    for (std::uint32_t& index : indices) index = objects[index].id;
    return indices;
  };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Object& object = objects[i];
    object.lies_on_ids = ids(graph.lies_on[i]);
    object.supports_ids = ids(graph.supports[i]);
    object.entangled_ids = ids(graph.entangled_with[i]);
    object.double_pick_ids = ids(graph.double_picks[i]);
    object.grs = scores[i];
    object.grs.neighbour_ids = ids(scores[i].neighbour_ids);
    object.grs.overlap_ids = ids(scores[i].overlap_ids);
  }
}

}  // namespace graspd::perception
