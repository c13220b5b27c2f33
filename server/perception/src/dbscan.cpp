#include "graspd/perception/dbscan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace graspd::perception {
namespace {

/// Union-find over cluster numbers; a set is named by its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::int32_t count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t find(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void merge(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

std::size_t common_count(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  std::size_t count = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (*i == *j) ++count;
    const bool advance_i = *i <= *j;
    const bool advance_j = *j <= *i;
    i += advance_i;
    j += advance_j;
  }
  return count;
}

/// Spreads one cluster over the core points that are density-reachable from `seed`.
void grow(std::uint32_t seed, const Neighbourhoods& neighbourhoods, DbscanResult& result,
          std::vector<std::uint32_t>& stack) {
  const std::int32_t label = result.clusters_n++;
  result.labels[seed] = label;
  stack.assign(1, seed);
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    for (const std::uint32_t j : neighbourhoods.of(i)) {
      if (!result.is_core[j] || result.labels[j] != kNoise) continue;
      result.labels[j] = label;
      stack.push_back(j);
    }
  }
}

}  // namespace

DbscanResult dbscan(const Cloud& cloud, const Neighbourhoods& neighbourhoods, int min_points_n) {
  const auto count = static_cast<std::uint32_t>(cloud.size());
  DbscanResult result;
  result.labels.assign(count, kNoise);
  result.is_core.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    result.is_core[i] = static_cast<int>(neighbourhoods.of(i).size()) >= min_points_n;
  }
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (result.is_core[i] && result.labels[i] == kNoise) grow(i, neighbourhoods, result, stack);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (result.is_core[i]) continue;
    float nearest2 = std::numeric_limits<float>::max();
    for (const std::uint32_t j : neighbourhoods.of(i)) {
      if (!result.is_core[j]) continue;
      const float distance2 = (cloud.points_m[i] - cloud.points_m[j]).squaredNorm();
      if (distance2 >= nearest2) continue;
      nearest2 = distance2;
      result.labels[i] = result.labels[j];
    }
  }
  return result;
}

void merge_at_borders(const Cloud& cloud, const Neighbourhoods& neighbourhoods,
                      double smoothness_rad, double curvature, DbscanResult& result) {
  const auto min_cosine = static_cast<float>(std::cos(smoothness_rad));
  const auto max_curvature = static_cast<float>(curvature);
  DisjointSets sets(result.clusters_n);
  for (std::uint32_t i = 0; i < result.labels.size(); ++i) {
    if (result.is_core[i] || result.labels[i] == kNoise) continue;
    std::size_t most_common = 0;
    std::uint32_t best = i;
    for (const std::uint32_t j : neighbourhoods.of(i)) {
      if (!result.is_core[j]) continue;
      const std::size_t common = common_count(neighbourhoods.of(i), neighbourhoods.of(j));
      if (common > most_common) {
        most_common = common;
        best = j;
      }
    }
    if (best == i || sets.find(result.labels[best]) == sets.find(result.labels[i])) continue;
    const bool smooth = cloud.normals[i].dot(cloud.normals[best]) > min_cosine;
    const bool alike = std::abs(cloud.curvatures[i] - cloud.curvatures[best]) < max_curvature;
    if (smooth && alike) sets.merge(result.labels[i], result.labels[best]);
  }
  std::vector<std::int32_t> renumbered(static_cast<std::size_t>(result.clusters_n), kNoise);
  std::int32_t next = 0;
  for (std::int32_t label = 0; label < result.clusters_n; ++label) {
    const std::int32_t root = sets.find(label);
    if (root == label) renumbered[label] = next++;
    renumbered[label] = renumbered[root];
  }
  for (std::int32_t& label : result.labels) {
    if (label != kNoise) label = renumbered[label];
  }
  result.clusters_n = next;
}

std::vector<Indices> clusters_of(const DbscanResult& result) {
  std::vector<Indices> clusters(static_cast<std::size_t>(result.clusters_n));
  for (std::uint32_t i = 0; i < result.labels.size(); ++i) {
    if (result.labels[i] != kNoise) clusters[result.labels[i]].push_back(i);
  }
  return clusters;
}

}  // namespace graspd::perception
