#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "mesh_geometry.hpp"

namespace graspd::parts {

inline constexpr double kItself_m = 1e-6;  ///< of the triangle that a ray starts on
inline constexpr double kOutside_m = 10;   ///< farther than any part is wide

/// Triangles in a tree of boxes: the nearest place on a surface, or what a ray meets, without
/// looking at all of it.
/// Exact. Immutable, so any number of threads may ask it.
class TriangleTree {
 public:
  struct Foot {
    double squared_distance_m2 = std::numeric_limits<double>::infinity();
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    const Triangle* triangle = nullptr;  ///< none: nothing is so near
  };

  struct Hit {
    double distance_m = std::numeric_limits<double>::infinity();
    const Triangle* triangle = nullptr;  ///< none: the ray meets nothing
  };

  explicit TriangleTree(std::vector<Triangle> triangles);
  explicit TriangleTree(const Mesh& mesh);

  /// Those given, long ones cut, degenerate ones left out.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  bool is_within(const Eigen::Vector3d& p_m, double distance_m) const;
  Foot nearest(const Eigen::Vector3d& p_m) const;
  /// What a ray of unit direction meets first, from either side, beyond a distance.
  Hit first_hit(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction,
                double beyond_m = 0) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box_m;
    std::size_t begin = 0, end = 0;   ///< in triangles_
    std::size_t left = 0, right = 0;  ///< 0 for a leaf: the root is nobody's child
  };

  struct Ray {
    Eigen::Vector3d from_m, direction, inverse;
  };

  std::size_t build(std::size_t begin, std::size_t end);
  /// Improves `best`; stops once it is at most `enough_m2`.
  void search(std::size_t node, const Eigen::Vector3d& p_m, double enough_m2, Foot& best) const;
  /// Improves `best`.
  void search(std::size_t node, const Ray& ray, double beyond_m, Hit& best) const;

  std::vector<Triangle> triangles_;  ///< each node's side by side
  std::vector<Node> nodes_;
};

}  // namespace graspd::parts
