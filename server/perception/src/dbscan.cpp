#include "graspd/perception/dbscan.hpp"

#include "dbscan_steps.hpp"

namespace graspd::perception {
namespace {

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

class StoredReach {
 public:
  StoredReach(const Cloud& cloud, const Neighbourhoods& neighbourhoods, const DbscanResult& result)
      : cloud_(cloud), neighbourhoods_(neighbourhoods), result_(result) {}
  template <class Visit>
  void visit_core(std::uint32_t i, Visit visit) const {
    for (const std::uint32_t j : neighbourhoods_.of(i)) {
      if (result_.is_core[j]) visit(j, (cloud_.points_m[i] - cloud_.points_m[j]).squaredNorm());
    }
  }
  auto common_with(std::uint32_t i) const {
    return [this, i](std::uint32_t j) {
      return common_count(neighbourhoods_.of(i), neighbourhoods_.of(j));
    };
  }

 private:
  const Cloud& cloud_;
  const Neighbourhoods& neighbourhoods_;
  const DbscanResult& result_;
};

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
  assign_border_points(StoredReach(cloud, neighbourhoods, result), result);
  return result;
}

void merge_at_borders(const Cloud& cloud, const Neighbourhoods& neighbourhoods,
                      double smoothness_rad, double curvature, DbscanResult& result) {
  merge_clusters_at_borders(cloud, StoredReach(cloud, neighbourhoods, result), smoothness_rad,
                            curvature, result);
}

std::vector<Indices> clusters_of(const DbscanResult& result) {
  std::vector<std::size_t> sizes(static_cast<std::size_t>(result.clusters_n), 0);
  for (const std::int32_t label : result.labels) {
    if (label != kNoise) ++sizes[label];
  }
  std::vector<Indices> clusters(sizes.size());
  for (std::size_t c = 0; c < sizes.size(); ++c) clusters[c].reserve(sizes[c]);
  for (std::uint32_t i = 0; i < result.labels.size(); ++i) {
    if (result.labels[i] != kNoise) clusters[result.labels[i]].push_back(i);
  }
  return clusters;
}

}  // namespace graspd::perception
