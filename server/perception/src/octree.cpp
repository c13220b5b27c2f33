#include "graspd/perception/octree.hpp"

#include <algorithm>
#include <numeric>

namespace graspd::perception {
namespace {

constexpr int kMortonBits = 16;
/// Testing this many points costs less than another level of boxes.
constexpr std::uint32_t kLeafPoints = 8;

/// Spreads 16 bits so that two zero bits follow each.
std::uint64_t spread(std::uint64_t v) {
  v = (v | (v << 32)) & 0xFFFF00000000FFFFULL;
  v = (v | (v << 16)) & 0x00FF0000FF0000FFULL;
  v = (v | (v << 8)) & 0xF00F00F00F00F00FULL;
  v = (v | (v << 4)) & 0x30C30C30C30C30C3ULL;
  v = (v | (v << 2)) & 0x9249249249249249ULL;
  return v;
}

}  // namespace

Octree::Octree(std::span<const Eigen::Vector3f> points_m, int max_depth_n) {
  if (points_m.empty()) return;
  Eigen::Vector3f low = points_m[0];
  Eigen::Vector3f high = points_m[0];
  for (const auto& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const float side_m = std::max((high - low).maxCoeff() * 1.0001f, 1e-6f);

  constexpr auto kCells = static_cast<float>(1 << kMortonBits);
  std::vector<std::uint64_t> unsorted(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3f cell = (points_m[i] - low) * (kCells / side_m);
    const auto axis = [&](int a) {
      return spread(static_cast<std::uint64_t>(std::clamp(cell[a], 0.0f, kCells - 1)));
    };
    unsorted[i] = axis(0) | axis(1) << 1 | axis(2) << 2;
  }
  order_.resize(points_m.size());
  std::iota(order_.begin(), order_.end(), 0U);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return unsorted[a] != unsorted[b] ? unsorted[a] < unsorted[b] : a < b;
  });
  std::vector<std::uint64_t> codes(order_.size());
  sorted_m_.resize(order_.size());
  for (std::size_t k = 0; k < order_.size(); ++k) {
    codes[k] = unsorted[order_[k]];
    sorted_m_[k] = points_m[order_[k]];
  }
  const auto end = static_cast<std::uint32_t>(order_.size());
  const Eigen::Vector3f centre_m = low + Eigen::Vector3f::Constant(side_m / 2);
  nodes_.push_back({centre_m, side_m / 2, 0, end, 0, 0});
  divide(0, 0, std::clamp(max_depth_n, 1, kMortonBits), codes);
}

void Octree::divide(std::uint32_t node, int depth, int max_depth_n,
                    std::span<const std::uint64_t> codes) {
  const Node parent = nodes_[node];
  if (depth == max_depth_n || parent.end - parent.begin <= kLeafPoints) return;
  const int shift = 3 * (kMortonBits - 1 - depth);
  const auto octant = [&](std::uint32_t k) { return (codes[k] >> shift) & 7U; };

  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t begin = parent.begin; begin < parent.end;) {
    const std::uint64_t which = octant(begin);
    const auto is_same = [&](std::uint64_t code) { return ((code >> shift) & 7U) == which; };
    const auto end = static_cast<std::uint32_t>(
        std::partition_point(codes.begin() + begin, codes.begin() + parent.end, is_same) -
        codes.begin());
    const float half_m = parent.half_m / 2;
    const Eigen::Vector3f step((which & 1U) != 0 ? half_m : -half_m,
                               (which & 2U) != 0 ? half_m : -half_m,
                               (which & 4U) != 0 ? half_m : -half_m);
    nodes_.push_back({parent.centre_m + step, half_m, begin, end, 0, 0});
    begin = end;
  }
  const auto last = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first_child = first;
  nodes_[node].children_n = last - first;
  for (std::uint32_t child = first; child < last; ++child) {
    divide(child, depth + 1, max_depth_n, codes);
  }
}

void Octree::radius_search(const Eigen::Vector3f& centre_m, float radius_m,
                           std::vector<std::uint32_t>& found) const {
  found.clear();
  if (nodes_.empty()) return;
  const float radius2 = radius_m * radius_m;
  std::uint32_t stack[8 * kMortonBits];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    const Eigen::Array3f outside =
        ((centre_m - node.centre_m).array().abs() - node.half_m).max(0.0f);
    // A point on the border of two octants may round into either: look a hair further.
    if (outside.square().sum() > radius2 * 1.002f + 1e-12f) continue;
    if (node.first_child == 0) {
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        if ((sorted_m_[k] - centre_m).squaredNorm() <= radius2) found.push_back(order_[k]);
      }
      continue;
    }
    for (std::uint32_t child = 0; child < node.children_n; ++child) {
      stack[top++] = node.first_child + child;
    }
  }
}

Neighbourhoods Octree::neighbourhoods(float radius_m) const {
  Neighbourhoods result;
  result.offsets.assign(order_.size() + 1, 0);
  // Searched in Morton order, where one search's nodes are still in the cache for the next.
  std::vector<std::vector<std::uint32_t>::size_type> starts(order_.size());
  std::vector<std::uint32_t> in_morton_order;
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    radius_search(sorted_m_[k], radius_m, found);
    starts[order_[k]] = in_morton_order.size();
    result.offsets[order_[k] + 1] = static_cast<std::uint32_t>(found.size());
    in_morton_order.insert(in_morton_order.end(), found.begin(), found.end());
  }
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.indices.resize(in_morton_order.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const auto out = result.indices.begin() + result.offsets[i];
    const auto count = result.offsets[i + 1] - result.offsets[i];
    std::copy_n(in_morton_order.begin() + static_cast<std::ptrdiff_t>(starts[i]), count, out);
    std::sort(out, out + count);
  }
  return result;
}

}  // namespace graspd::perception
