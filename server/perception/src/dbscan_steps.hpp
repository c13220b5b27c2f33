#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "graspd/perception/dbscan.hpp"

/// What DBSCAN does with its border points, however the neighbourhoods are found. A `Reach` has
///   visit_core(i, f)  calls f(j, distance2) for each core point j within Eps of point i, in any
///                     order;
///   common_with(i)    a function of j: how many points the neighbourhoods of i and j both have.
namespace graspd::perception {

/// Union-find over cluster numbers; a set is named by its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::int32_t count = 0) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  /// \returns the new set's name.
  std::int32_t add() {
    parent_.push_back(static_cast<std::int32_t>(parent_.size()));
    return parent_.back();
  }
  std::int32_t find(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// \returns the common set's name.
  std::int32_t merge(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    return parent_[std::max(a, b)] = std::min(a, b);
  }
  /// For each member the number of its set; sets are numbered from 0 in the order of their names.
  std::vector<std::int32_t> numbers() {
    std::vector<std::int32_t> result(parent_.size());
    std::int32_t next = 0;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(parent_.size()); ++i) {
      const std::int32_t root = find(i);
      result[i] = root == i ? next++ : result[root];
    }
    return result;
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// Gives each point label its set's number.
inline void renumber(DisjointSets& sets, DbscanResult& result) {
  const std::vector<std::int32_t> numbers = sets.numbers();
  result.clusters_n = 0;
  for (const std::int32_t number : numbers) {
    result.clusters_n = std::max(result.clusters_n, number + 1);
  }
  for (std::int32_t& label : result.labels) {
    if (label != kNoise) label = numbers[label];
  }
}

/// To the cluster of the nearest core point; of equally near ones to that of the first.
template <class Reach>
void assign_border_points(const Reach& reach, DbscanResult& result) {
  for (std::uint32_t i = 0; i < result.labels.size(); ++i) {
    if (result.is_core[i]) continue;
    float nearest2 = std::numeric_limits<float>::max();
    std::uint32_t nearest = i;
    reach.visit_core(i, [&](std::uint32_t j, float distance2) {
      if (distance2 > nearest2 || (distance2 == nearest2 && j > nearest)) return;
      nearest2 = distance2;
      nearest = j;
    });
    if (nearest != i) result.labels[i] = result.labels[nearest];
  }
}

/// The core point in reach whose neighbourhood has most in common with border point i's; the first
/// of equal ones.
template <class Reach>
std::uint32_t best_partner(const Reach& reach, std::uint32_t i) {
  const auto common_n = reach.common_with(i);
  std::size_t most_common = 0;
  std::uint32_t best = i;
  reach.visit_core(i, [&](std::uint32_t j, float) {
    const std::size_t common = common_n(j);
    if (common < most_common || (common == most_common && j > best)) return;
    most_common = common;
    best = j;
  });
  return best;
}

template <class Reach>
void merge_clusters_at_borders(const Cloud& cloud, const Reach& reach, double smoothness_rad,
                               double curvature, DbscanResult& result) {
  const auto min_cosine = static_cast<float>(std::cos(smoothness_rad));
  const auto max_curvature = static_cast<float>(curvature);
  DisjointSets sets(result.clusters_n);
  for (std::uint32_t i = 0; i < result.labels.size(); ++i) {
    if (result.is_core[i] || result.labels[i] == kNoise) continue;
    // Most border points reach one cluster only, and have nothing to merge.
    const std::int32_t own = sets.find(result.labels[i]);
    bool is_between = false;
    reach.visit_core(i, [&](std::uint32_t j, float) {
      is_between = is_between || sets.find(result.labels[j]) != own;
    });
    if (!is_between) continue;
    const std::uint32_t best = best_partner(reach, i);
    const bool smooth = cloud.normals[i].dot(cloud.normals[best]) > min_cosine;
    const bool alike = std::abs(cloud.curvatures[i] - cloud.curvatures[best]) < max_curvature;
    if (smooth && alike) sets.merge(own, result.labels[best]);
  }
  renumber(sets, result);
}

}  // namespace graspd::perception
