#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "graspd/parts/mesh.hpp"

// The farthest pair of n points without looking at n² pairs: points lie in a tree of boxes, and a
// pair of boxes whose farthest corners are nearer than a pair of points already found is skipped.
// Exact. A sphere, where every point has a partner, is the worst case; parts take milliseconds.

namespace graspd::parts {
namespace {

class FarthestPair {
 public:
  explicit FarthestPair(std::vector<Eigen::Vector3f> points) : points_(std::move(points)) {
    if (!points_.empty()) build(0, points_.size());
  }

  double distance() {
    if (nodes_.empty()) return 0;
    sweep();
    search(0, 0);
    return std::sqrt(best_squared_);
  }

 private:
  static constexpr std::size_t kLeafPoints = 16;

  struct Node {
    Eigen::Array3d min, max;
    std::size_t begin = 0, end = 0;   ///< in points_
    std::size_t left = 0, right = 0;  ///< 0 for a leaf: the root is nobody's child
  };

  Eigen::Vector3d point(std::size_t k) const { return points_[k].cast<double>(); }

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t index = nodes_.size();
    Node node;
    node.begin = begin;
    node.end = end;
    node.min = node.max = point(begin).array();
    for (std::size_t k = begin + 1; k < end; ++k) {
      node.min = node.min.min(point(k).array());
      node.max = node.max.max(point(k).array());
    }
    nodes_.push_back(node);
    if (end - begin <= kLeafPoints) return index;
    Eigen::Index axis = 0;
    (node.max - node.min).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t k) {
      return points_.begin() + static_cast<std::ptrdiff_t>(k);
    };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    const std::size_t left = build(begin, middle);
    const std::size_t right = build(middle, end);
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
  }

  /// A good first answer: from any point to the farthest from it, and again from there.
  void sweep() {
    Eigen::Vector3d from = point(0);
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3d farthest = from;
      for (std::size_t k = 0; k < points_.size(); ++k) {
        if ((point(k) - from).squaredNorm() > (farthest - from).squaredNorm()) farthest = point(k);
      }
      best_squared_ = std::max(best_squared_, (farthest - from).squaredNorm());
      from = farthest;
    }
  }

  double bound_squared(std::size_t a, std::size_t b) const {
    const Node& m = nodes_[a];
    const Node& n = nodes_[b];
    return (m.max - n.min).max(n.max - m.min).square().sum();
  }

  void search(std::size_t a, std::size_t b) {
    if (bound_squared(a, b) <= best_squared_) return;
    const bool a_is_leaf = nodes_[a].left == 0;
    const bool b_is_leaf = nodes_[b].left == 0;
    if (a_is_leaf && b_is_leaf) return compare_points(a, b);
    if (a == b) {
      search(nodes_[a].left, nodes_[a].right);
      search(nodes_[a].left, nodes_[a].left);
      search(nodes_[a].right, nodes_[a].right);
      return;
    }
    const std::size_t size_a = nodes_[a].end - nodes_[a].begin;
    const std::size_t size_b = nodes_[b].end - nodes_[b].begin;
    if (a_is_leaf || (!b_is_leaf && size_b > size_a)) std::swap(a, b);
    std::size_t nearer = nodes_[a].left;
    std::size_t farther = nodes_[a].right;
    if (bound_squared(nearer, b) > bound_squared(farther, b)) std::swap(nearer, farther);
    search(farther, b);
    search(nearer, b);
  }

  void compare_points(std::size_t a, std::size_t b) {
    for (std::size_t i = nodes_[a].begin; i < nodes_[a].end; ++i) {
      for (std::size_t j = nodes_[b].begin; j < nodes_[b].end; ++j) {
        best_squared_ = std::max(best_squared_, (point(i) - point(j)).squaredNorm());
      }
    }
  }

  std::vector<Eigen::Vector3f> points_;  ///< each node's side by side
  std::vector<Node> nodes_;
  double best_squared_ = 0;
};

}  // namespace

double diameter_m(const Mesh& mesh) { return FarthestPair(mesh.vertices_m).distance(); }

}  // namespace graspd::parts
