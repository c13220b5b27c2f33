#include "graspd/perception/grs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contacts.hpp"

namespace graspd::perception {

double p_self(double height_m, double inclination, const GrsParameters& parameters) {
  return parameters.k1 * height_m + parameters.k2 * std::sin(inclination);
}

double inclination_rad(const Eigen::Vector3d& axis) {
  return std::atan2(std::abs(axis.z()), axis.head<2>().norm());
}

PGrasp p_grasp(std::size_t target, std::span<const Eigen::Vector3d> centroids_m,
               const GrsParameters& parameters) {
  const auto distance2 = [&](std::uint32_t i) {
    return (centroids_m[i] - centroids_m[target]).squaredNorm();
  };
  // A bin shows tens of parts: sorting costs less than building a KD-tree, and finds the same.
  PGrasp result;
  result.neighbours.resize(centroids_m.size());
  std::iota(result.neighbours.begin(), result.neighbours.end(), 0U);
  std::erase(result.neighbours, static_cast<std::uint32_t>(target));
  std::stable_sort(result.neighbours.begin(), result.neighbours.end(),
                   [&](auto a, auto b) { return distance2(a) < distance2(b); });
  const auto K = static_cast<std::size_t>(parameters.neighbours_n);
  if (result.neighbours.size() > K) result.neighbours.resize(K);
  double sum_m2 = static_cast<double>(K - result.neighbours.size()) *
                  parameters.isolation_distance_m * parameters.isolation_distance_m;
  for (const std::uint32_t i : result.neighbours) sum_m2 += distance2(i);
  result.value_m2 = sum_m2 / static_cast<double>(K);
  return result;
}

PSystemCount p_system_count(std::size_t target, std::span<const PlacedPart> parts,
                            const GrsParameters& parameters) {
  PSystemCount result;
  std::vector<bool> is_shared(parts[target].part->contact.points().size());
  for (std::uint32_t other = 0; other < parts.size(); ++other) {
    if (other == target) continue;
    bool touches = false;
    visit_near_points(parts[target], parts[other], parameters.overlap_distance_m,
                      [&](const NearPoints& near) { touches = is_shared[near.index] = true; });
    if (touches) result.others.push_back(other);
  }
  result.points_n =
      static_cast<std::uint32_t>(std::count(is_shared.begin(), is_shared.end(), true));
  const bool supports =
      result.points_n > static_cast<std::uint32_t>(parameters.overlap_threshold_n);
  result.value = supports ? 0 : 1;
  return result;
}

double p_system_support(double load, double cover) { return 1 / (1 + load + cover); }

std::vector<GrsTerms> grasp_risk_scores(std::span<const PlacedPart> parts, const PileGraph& graph,
                                        const GrsParameters& parameters) {
  std::vector<Eigen::Vector3d> centroids_m;
  for (const PlacedPart& part : parts) centroids_m.push_back(part.barycentre_m());
  std::vector<GrsTerms> scores(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    GrsTerms& terms = scores[i];
    terms.height_m = centroids_m[i].z();
    terms.inclination_rad = inclination_rad(parts[i].principal_axis());
    terms.p_self = p_self(terms.height_m, terms.inclination_rad, parameters);
    PGrasp neighbours = p_grasp(i, centroids_m, parameters);
    terms.p_grasp = neighbours.value_m2;
    terms.neighbour_ids = std::move(neighbours.neighbours);
    if (parameters.p_system == PSystem::kSupport) {
      terms.load = graph.load[i];
      terms.cover = graph.cover[i];
      terms.p_system = p_system_support(terms.load, terms.cover);
    } else {
      PSystemCount overlap = p_system_count(i, parts, parameters);
      terms.p_system = overlap.value;
      terms.overlap_points_n = overlap.points_n;
      terms.overlap_ids = std::move(overlap.others);
    }
    terms.grs = (parameters.alpha * terms.p_self + parameters.beta * terms.p_grasp) *
                terms.p_system * std::pow(parts[i].score, parameters.confidence);
  }
  return scores;
}

bool ranks_before(const GrsTerms& a, const GrsTerms& b, const GrsParameters& parameters) {
  const auto free_risk = [&](const GrsTerms& terms) {
    return parameters.alpha * terms.p_self + parameters.beta * terms.p_grasp;
  };
  const auto key = [&](const GrsTerms& terms) { return std::pair(terms.grs, free_risk(terms)); };
  return parameters.order == GraspOrder::kAscending ? key(a) < key(b) : key(a) > key(b);
}

}  // namespace graspd::perception
