#include "graspd/perception/pile_graph.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "contacts.hpp"
#include "overlaps.hpp"
#include "pairs.hpp"

namespace graspd::perception {
namespace {

/// Surfaces that face each other: the angle between their normals is more than 107°.
constexpr float kFacingCosine = -0.3f;
/// Fewer contact points, each weighed by how upright its normal is, are an accident of sampling.
constexpr float kMinContact = 1.5f;
/// Where one part bears another: contact points, each weighed by how upright its normal is.
struct Bearing {
  float weight = 0;
  Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();

  void add(const Eigen::Vector3f& p_floor_m, float upward) {
    weight += upward;
    sum_m += upward * p_floor_m;
  }
};

/// Parts with the lowest barycentre first; x and y decide where that is as low.
std::vector<std::uint32_t> from_the_lowest(std::span<const PlacedPart> parts) {
  std::vector<std::tuple<double, double, double, std::uint32_t>> places;
  for (const PlacedPart& part : parts) {
    const Eigen::Vector3d p_m = part.barycentre_m();
    places.emplace_back(p_m.z(), p_m.x(), p_m.y(), static_cast<std::uint32_t>(places.size()));
  }
  std::ranges::sort(places);
  std::vector<std::uint32_t> order;
  for (const auto& place : places) order.push_back(std::get<3>(place));
  return order;
}

/// bearings(upper, lower), from the contacts of each two parts.
Pairs<Bearing> find_bearings(std::span<const PlacedPart> parts, const PileParameters& parameters) {
  Pairs<Bearing> bearings(parts.size());
  const auto least = static_cast<float>(parameters.min_upward);
  const std::vector<std::uint32_t> order = from_the_lowest(parts);
  // One way is enough, and which one must not depend on the parts' order.
  for (auto lower = order.begin(); lower != order.end(); ++lower) {
    const std::uint32_t a = *lower;
    const Eigen::Isometry3f T_floor_a = parts[a].T_floor_part.cast<float>();
    for (auto upper = std::next(lower); upper != order.end(); ++upper) {
      const std::uint32_t b = *upper;
      visit_near_points(parts[b], parts[a], parameters.contact_m, [&](const NearPoints& near) {
        if (near.normal.dot(near.other.normal) > kFacingCosine) return;
        const Eigen::Vector3f away = (near.other.normal - near.normal).normalized();
        const float upward = T_floor_a.linear().row(2).dot(away);
        if (upward > least) bearings(b, a).add(T_floor_a * near.p_m, upward);
        if (upward < -least) bearings(a, b).add(T_floor_a * near.p_m, -upward);
      });
    }
  }
  return bearings;
}

/// Where the part stands on the floor.
Bearing floor_bearing(const PlacedPart& part, double contact_m) {
  Bearing floor;
  if (part.barycentre_m().z() > part.part->radius_m + contact_m) return floor;
  const Eigen::Isometry3f T_floor_part = part.T_floor_part.cast<float>();
  for (const parts::SurfacePoint& point : part.part->contact.points()) {
    const Eigen::Vector3f p_m = T_floor_part * point.position_m;
    if (p_m.z() < static_cast<float>(contact_m)) floor.add(p_m, 1);
  }
  return floor;
}

/// What bears a part, and how much of its weight.
struct Force {
  std::uint32_t lower;    ///< the part itself: the floor
  Eigen::Vector3d lever;  ///< 1, and the way from the barycentre along x and y, in radii
  double share = 0;
};

/// The forces f ≥ 0 that come nearest to equilibrium: Σ f = 1, and no torque about the barycentre,
/// Σ f·d = 0. What is not registered bears too, so that there need not be one. Non-negative least
/// squares by coordinate descent.
void balance(std::vector<Force>& forces) {
  constexpr int kSweeps = 30;
  constexpr double kDamping = 0.02;  // what bears at the same place bears the same
  Eigen::Vector3d rest = Eigen::Vector3d::UnitX();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Force& force : forces) {
      const double step =
          (force.lever.dot(rest) - kDamping * force.share) / (force.lever.squaredNorm() + kDamping);
      const double share = std::max(0.0, force.share + step);
      rest -= (share - force.share) * force.lever;
      force.share = share;
    }
  }
}

/// One part lies on another.
struct Edge {
  std::uint32_t upper, lower;
  double share;  ///< of the upper one's weight
};

std::vector<Edge> find_edges(std::span<const PlacedPart> parts, const PileParameters& parameters) {
  const Pairs<Bearing> bearings = find_bearings(parts, parameters);
  std::vector<Edge> edges;
  std::vector<Force> forces;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    const auto add = [&](std::uint32_t lower, const Bearing& bearing) {
      const Eigen::Vector3d centre_m = (bearing.sum_m / bearing.weight).cast<double>();
      const Eigen::Vector3d d = (centre_m - parts[i].barycentre_m()) / parts[i].part->radius_m;
      forces.push_back({lower, {1, d.x(), d.y()}});
    };
    forces.clear();
    for (std::uint32_t j = 0; j < parts.size(); ++j) {
      const float weight = bearings(i, j).weight;
      if (weight >= kMinContact && weight > bearings(j, i).weight) add(j, bearings(i, j));
    }
    if (forces.empty()) continue;
    const Bearing floor = floor_bearing(parts[i], parameters.contact_m);
    if (floor.weight > 0) add(i, floor);
    // The same steps whatever the parts' order.
    std::ranges::sort(
        forces, {}, [](const Force& force) { return std::pair(force.lever.y(), force.lever.z()); });
    balance(forces);
    for (const Force& force : forces) {
      const bool bears = force.lower != i && force.share >= parameters.min_share;
      if (bears) edges.push_back({i, force.lower, force.share});
    }
  }
  return edges;
}

/// Whether `from` lies on `to`, directly or through others.
bool leads_to(std::uint32_t from, std::uint32_t to, const PileGraph& graph) {
  return from == to || std::ranges::any_of(graph.lies_on[from], [&](std::uint32_t below) {
           return leads_to(below, to, graph);
         });
}

/// What bears most goes in first, so that of a ring the edge that bears least is left out.
void add_edges(std::vector<Edge>& edges, PileGraph& graph) {
  std::ranges::stable_sort(edges, std::ranges::greater(), &Edge::share);
  std::erase_if(edges, [&](const Edge& edge) {
    const bool closes_ring = leads_to(edge.lower, edge.upper, graph);
    if (closes_ring) {
      graph.entangled_with[edge.upper].push_back(edge.lower);
      graph.entangled_with[edge.lower].push_back(edge.upper);
    } else {
      graph.lies_on[edge.upper].push_back(edge.lower);
      graph.supports[edge.lower].push_back(edge.upper);
    }
    return closes_ring;
  });
}

/// Weight goes down from part to part: each hands on its own and what rests on it.
void add_load(const std::vector<Edge>& edges, PileGraph& graph) {
  std::vector<std::size_t> not_handed_n;  // of the parts that rest on each
  for (const auto& upper : graph.supports) not_handed_n.push_back(upper.size());
  std::vector<std::uint32_t> complete;
  for (std::uint32_t i = 0; i < not_handed_n.size(); ++i) {
    if (not_handed_n[i] == 0) complete.push_back(i);
  }
  for (std::size_t next = 0; next < complete.size(); ++next) {
    for (const Edge& edge : edges) {
      if (edge.upper != complete[next]) continue;
      graph.load[edge.lower] += edge.share * (1 + graph.load[edge.upper]);
      if (--not_handed_n[edge.lower] == 0) complete.push_back(edge.lower);
    }
  }
}

void add_overlaps(std::span<const PlacedPart> parts, const PileParameters& parameters,
                  PileGraph& graph) {
  const Pairs<int> overlaps = find_overlaps(parts, parameters.contact_m);
  const auto over = [&](std::size_t upper, std::size_t lower) {
    const int least = std::max(1, std::min(overlaps(upper, upper), overlaps(lower, lower)));
    return static_cast<double>(overlaps(upper, lower)) / least;
  };
  for (std::uint32_t lower = 0; lower < parts.size(); ++lower) {
    for (std::uint32_t upper = 0; upper < parts.size(); ++upper) {
      if (upper == lower || overlaps(upper, lower) == 0) continue;
      const double share = over(upper, lower);
      graph.cover[lower] += share;
      if (share >= parameters.min_double_pick_over) graph.double_picks[lower].push_back(upper);
      const double least = std::min(share, over(lower, upper));
      if (least >= parameters.min_entangled_over) graph.entangled_with[lower].push_back(upper);
    }
  }
}

void sort_unique(std::vector<std::vector<std::uint32_t>>& lists) {
  for (auto& list : lists) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

}  // namespace

PileGraph make_pile_graph(std::span<const PlacedPart> parts, const PileParameters& parameters) {
  PileGraph graph;
  for (auto* lists :
       {&graph.lies_on, &graph.supports, &graph.entangled_with, &graph.double_picks}) {
    lists->resize(parts.size());
  }
  graph.load.resize(parts.size());
  graph.cover.resize(parts.size());
  std::vector<Edge> edges = find_edges(parts, parameters);
  add_edges(edges, graph);
  add_load(edges, graph);
  add_overlaps(parts, parameters, graph);
  for (auto* lists : {&graph.lies_on, &graph.supports, &graph.entangled_with}) sort_unique(*lists);
  return graph;
}

}  // namespace graspd::perception
