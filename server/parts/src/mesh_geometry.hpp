#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// One triangle in double precision.
struct Triangle {
  std::array<Eigen::Vector3d, 3> corners_m;

  /// Twice the area long; zero for a degenerate triangle.
  Eigen::Vector3d area_vector_m2() const {
    return (corners_m[1] - corners_m[0]).cross(corners_m[2] - corners_m[0]);
  }
  double area_m2() const { return 0.5 * area_vector_m2().norm(); }
  Eigen::Vector3d centroid_m() const { return (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0; }
};

inline Triangle triangle_of(const Mesh& mesh, const std::array<int, 3>& indices) {
  const auto corner = [&](int index) -> Eigen::Vector3d {
    return mesh.vertices_m[static_cast<std::size_t>(index)].cast<double>();
  };
  return {{corner(indices[0]), corner(indices[1]), corner(indices[2])}};
}

/// The sign of an axis is free: fix it, so that one mesh has one.
Eigen::Vector3d with_fixed_sign(const Eigen::Vector3d& axis);

/// Eigenvectors of the surface's covariance as columns, largest variance first, right-handed.
Eigen::Matrix3d principal_axes(const Mesh& mesh);

/// Whether the triangles face inwards on the whole. Of a surface with holes too, but not of a flat
/// sheet, which has no inside.
bool is_inside_out(const Mesh& mesh);

}  // namespace graspd::parts
