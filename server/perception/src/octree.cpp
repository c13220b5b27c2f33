#include "graspd/perception/octree.hpp"

#include <algorithm>
#include <utility>

#include "neighbour_kernel.hpp"

namespace graspd::perception {
namespace {

constexpr int kMortonBits = 16;
/// Testing this many points, in vectors, costs less than another level of boxes.
constexpr std::uint32_t kLeafPoints = 32;

/// Spreads 16 bits so that two zero bits follow each.
std::uint64_t spread(std::uint64_t v) {
  v = (v | (v << 32)) & 0xFFFF00000000FFFFULL;
  v = (v | (v << 16)) & 0x00FF0000FF0000FFULL;
  v = (v | (v << 8)) & 0xF00F00F00F00F00FULL;
  v = (v | (v << 4)) & 0x30C30C30C30C30C3ULL;
  v = (v | (v << 2)) & 0x9249249249249249ULL;
  return v;
}

/// The points of some leaves, as the kernel wants them.
class Candidates {
 public:
  void clear() { size_ = 0; }
  void add(const Eigen::Vector3f& p_m, std::uint32_t point) {
    if (size_ + kNeighbourPadding >= points_.size()) {
      for (auto* values : {&x_m_, &y_m_, &z_m_}) values->resize(2 * size_ + 4 * kNeighbourPadding);
      points_.resize(x_m_.size());
      found_.resize(x_m_.size());
    }
    x_m_[size_] = p_m.x();
    y_m_[size_] = p_m.y();
    z_m_[size_] = p_m.z();
    points_[size_++] = point;
  }
  std::span<const std::uint32_t> within(float radius_m, const Eigen::Vector3f& p_m) {
    const std::size_t found_n = ids_within({x_m_.data(), y_m_.data(), z_m_.data()}, points_.data(),
                                           size_, p_m.data(), radius_m * radius_m, found_.data());
    return {found_.data(), found_n};
  }

 private:
  std::size_t size_ = 0;
  std::vector<float> x_m_, y_m_, z_m_;
  std::vector<std::uint32_t> points_, found_;
};

/// Neighbourhoods in the points' own order and ascending, from those of points `found_of`. A
/// neighbour's neighbour is the point itself: each point in turn is handed to its neighbours.
Neighbourhoods ascending(const Neighbourhoods& found, std::span<const std::uint32_t> found_of) {
  std::vector<std::uint32_t> place(found_of.size());
  for (std::uint32_t k = 0; k < found_of.size(); ++k) place[found_of[k]] = k;
  Neighbourhoods result;
  result.offsets.push_back(0);
  for (const std::uint32_t k : place) {
    result.offsets.push_back(result.offsets.back() +
                             static_cast<std::uint32_t>(found.of(k).size()));
  }
  result.indices.resize(found.indices.size());
  std::vector<std::uint32_t> next = result.offsets;
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    for (const std::uint32_t j : found.of(place[i])) result.indices[next[j]++] = i;
  }
  return result;
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
  std::vector<std::pair<std::uint64_t, std::uint32_t>> by_code(points_m.size());
  for (std::uint32_t i = 0; i < by_code.size(); ++i) {
    const Eigen::Vector3f cell = (points_m[i] - low) * (kCells / side_m);
    const auto axis = [&](int a) {
      return spread(static_cast<std::uint64_t>(std::clamp(cell[a], 0.0f, kCells - 1)));
    };
    by_code[i] = {axis(0) | axis(1) << 1 | axis(2) << 2, i};
  }
  std::sort(by_code.begin(), by_code.end());
  std::vector<std::uint64_t> codes;
  codes.reserve(by_code.size());
  order_.reserve(by_code.size());
  sorted_m_.reserve(by_code.size());
  for (const auto& [code, i] : by_code) {
    codes.push_back(code);
    order_.push_back(i);
    sorted_m_.push_back(points_m[i]);
  }
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(order_.size()), 0, 0});
  divide(0, 0, std::clamp(max_depth_n, 1, kMortonBits), codes);
}

void Octree::divide(std::uint32_t node, int depth, int max_depth_n,
                    std::span<const std::uint64_t> codes) {
  const Node parent = nodes_[node];
  if (depth == max_depth_n || parent.end - parent.begin <= kLeafPoints) {
    for (std::uint32_t k = parent.begin; k < parent.end; ++k)
      nodes_[node].box_m.extend(sorted_m_[k]);
    return;
  }
  const int shift = 3 * (kMortonBits - 1 - depth);
  const auto octant = [&](std::uint32_t k) { return (codes[k] >> shift) & 7U; };

  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t begin = parent.begin; begin < parent.end;) {
    const std::uint64_t which = octant(begin);
    const auto is_same = [&](std::uint64_t code) { return ((code >> shift) & 7U) == which; };
    const auto end = static_cast<std::uint32_t>(
        std::partition_point(codes.begin() + begin, codes.begin() + parent.end, is_same) -
        codes.begin());
    nodes_.push_back({{}, begin, end, 0, 0});
    begin = end;
  }
  const auto last = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first_child = first;
  nodes_[node].children_n = last - first;
  for (std::uint32_t child = first; child < last; ++child) {
    divide(child, depth + 1, max_depth_n, codes);
    nodes_[node].box_m.extend(nodes_[child].box_m);
  }
}

template <class Distance2, class Visit>
void Octree::for_leaves_within(float radius_m, Distance2 distance2, Visit visit) const {
  if (nodes_.empty()) return;
  const float radius2 = radius_m * radius_m;
  std::uint32_t stack[8 * kMortonBits];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    // A hair further: the points' own distances are rounded in another way.
    if (distance2(node.box_m) > radius2 * 1.002f + 1e-12f) continue;
    if (node.first_child == 0) {
      visit(node);
      continue;
    }
    for (std::uint32_t child = 0; child < node.children_n; ++child) {
      stack[top++] = node.first_child + child;
    }
  }
}

void Octree::radius_search(const Eigen::Vector3f& centre_m, float radius_m,
                           std::vector<std::uint32_t>& found) const {
  found.clear();
  const auto distance2 = [&](const Eigen::AlignedBox3f& box_m) {
    return box_m.squaredExteriorDistance(centre_m);
  };
  for_leaves_within(radius_m, distance2, [&](const Node& leaf) {
    for (std::uint32_t k = leaf.begin; k < leaf.end; ++k) {
      if ((sorted_m_[k] - centre_m).squaredNorm() <= radius_m * radius_m) {
        found.push_back(order_[k]);
      }
    }
  });
}

Neighbourhoods Octree::neighbourhoods(float radius_m) const {
  Neighbourhoods found;  // unsorted, leaf by leaf
  found.offsets.push_back(0);
  std::vector<std::uint32_t> found_of;
  Candidates candidates;
  for (const Node& leaf : nodes_) {
    if (leaf.first_child != 0) continue;
    candidates.clear();
    const auto distance2 = [&](const Eigen::AlignedBox3f& box_m) {
      return box_m.squaredExteriorDistance(leaf.box_m);
    };
    for_leaves_within(radius_m, distance2, [&](const Node& near) {
      for (std::uint32_t k = near.begin; k < near.end; ++k) candidates.add(sorted_m_[k], order_[k]);
    });
    for (std::uint32_t k = leaf.begin; k < leaf.end; ++k) {
      const auto within = candidates.within(radius_m, sorted_m_[k]);
      found.indices.insert(found.indices.end(), within.begin(), within.end());
      found_of.push_back(order_[k]);
      found.offsets.push_back(static_cast<std::uint32_t>(found.indices.size()));
    }
  }
  return ascending(found, found_of);
}

}  // namespace graspd::perception
