#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/perception/cloud.hpp"

namespace graspd::perception {

/// The Eps-neighbourhoods of all points of a cloud, one after the other: those of point i are
/// `indices[offsets[i] … offsets[i + 1])`, ascending, the point itself among them.
struct Neighbourhoods {
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint32_t> indices;

  std::span<const std::uint32_t> of(std::uint32_t i) const {
    return {indices.data() + offsets[i], indices.data() + offsets[i + 1]};
  }
};

/// Octree over the bounding cube of a point set (the paper, III-B.1, after Han 2018): an octant is
/// divided only where it bears points, until the depth is reached or few points are left. Points
/// are stored in Morton order, so that a node is a range of them.
class Octree {
 public:
  /// \param points_m finite; must outlive the octree. \param max_depth_n 1 … 16.
  Octree(std::span<const Eigen::Vector3f> points_m, int max_depth_n);

  /// Replaces `found` by the points whose distance to `centre_m` is at most `radius_m`, in no
  /// particular order.
  void radius_search(const Eigen::Vector3f& centre_m, float radius_m,
                     std::vector<std::uint32_t>& found) const;

  /// Of all points at once: each leaf looks up the leaves near it, and tests their points.
  Neighbourhoods neighbourhoods(float radius_m) const;

 private:
  struct Node {
    Eigen::AlignedBox3f box_m;  ///< around its points, in which it may be smaller than its octant
    std::uint32_t begin, end;   ///< range in order_
    std::uint32_t first_child;  ///< in nodes_; 0 for a leaf
    std::uint32_t children_n;
  };
  void divide(std::uint32_t node, int depth, int max_depth_n, std::span<const std::uint64_t> codes);
  /// Calls visit(leaf) for each leaf whose `distance2(its box)` is at most `radius_m`².
  template <class Distance2, class Visit>
  void for_leaves_within(float radius_m, Distance2 distance2, Visit visit) const;

  std::vector<Eigen::Vector3f> sorted_m_;
  std::vector<std::uint32_t> order_;  ///< sorted_m_[k] is the input's point order_[k]
  std::vector<Node> nodes_;
};

}  // namespace graspd::perception
