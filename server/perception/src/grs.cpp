#include "graspd/perception/grs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graspd/perception/octree.hpp"

namespace graspd::perception {
namespace {

constexpr int kTemplateOctreeDepth = 8;

}  // namespace

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
  const PlacedPart& object = parts[target];
  std::vector<Eigen::Vector3f> points_m;
  for (const auto& point : object.part->surface) points_m.push_back(point.position_m);
  const Octree octree(points_m, kTemplateOctreeDepth);
  std::vector<bool> is_shared(points_m.size());

  // Nothing of the object is farther from its barycentre.
  const double reach_m = object.part->radius_m + parameters.overlap_distance_m;
  const Eigen::Vector3f barycentre_m = object.part->barycentre_m.cast<float>();
  const auto reach2_m2 = static_cast<float>(reach_m * reach_m);

  PSystemCount result;
  std::vector<std::uint32_t> found;
  for (std::uint32_t other = 0; other < parts.size(); ++other) {
    const double distance_m = (object.barycentre_m() - parts[other].barycentre_m()).norm();
    if (other == target || distance_m > reach_m + parts[other].part->radius_m) continue;
    const Eigen::Isometry3f T_target_other =
        (object.T_floor_part.inverse() * parts[other].T_floor_part).cast<float>();
    bool touches = false;
    for (const auto& point : parts[other].part->surface) {
      const Eigen::Vector3f p_m = T_target_other * point.position_m;
      if ((p_m - barycentre_m).squaredNorm() > reach2_m2) continue;
      octree.radius_search(p_m, static_cast<float>(parameters.overlap_distance_m), found);
      touches |= !found.empty();
      for (const std::uint32_t i : found) is_shared[i] = true;
    }
    if (touches) result.others.push_back(other);
  }
  result.points_n =
      static_cast<std::uint32_t>(std::count(is_shared.begin(), is_shared.end(), true));
  const bool supports =
      result.points_n > static_cast<std::uint32_t>(parameters.overlap_threshold_n);
  result.value = supports ? 0 : 1;
  return result;
}

std::vector<GrsTerms> grasp_risk_scores(std::span<const PlacedPart> parts,
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
    PSystemCount overlap = p_system_count(i, parts, parameters);
    terms.p_system = overlap.value;
    terms.overlap_points_n = overlap.points_n;
    terms.overlap_ids = std::move(overlap.others);
    terms.grs =
        (parameters.alpha * terms.p_self + parameters.beta * terms.p_grasp) * terms.p_system;
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
