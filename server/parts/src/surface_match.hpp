#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "triangle_tree.hpp"

namespace graspd::parts {

/// A surface laid over itself, turned about its barycentre, which every symmetry leaves in place.
class SurfaceMatch {
 public:
  explicit SurfaceMatch(const Mesh& mesh);

  const Eigen::Vector3d& centre_m() const { return centre_m_; }
  /// About the centre; cut where they were long.
  const std::vector<Triangle>& triangles() const { return tree_.triangles(); }

  /// Whether the turned surface lies within a distance of the unturned one everywhere: points all
  /// over it and vertices are looked at. The other way round is the inverse turn's question.
  bool covers(const Eigen::Quaterniond& turn, double distance_m);
  /// The same by a tenth of the points.
  bool covers_roughly(const Eigen::Quaterniond& turn, double distance_m);
  /// The turn nearby that lays the surface best over itself: point-to-plane ICP over rotations.
  Eigen::Quaterniond settled(const Eigen::Quaterniond& turn) const;

 private:
  /// A point that a turn takes off the surface comes nearer to the front: likely the next turn does
  /// so as well.
  bool covers(std::vector<Eigen::Vector3d>& points_m, const Eigen::Quaterniond& turn,
              double distance_m) const;

  Eigen::Vector3d centre_m_;
  TriangleTree tree_;  ///< about the centre
  std::vector<Eigen::Vector3d> points_m_, rough_points_m_;
};

}  // namespace graspd::parts
