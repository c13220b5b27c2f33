#pragma once

#include <vector>

#include "graspd/parts/mesh.hpp"

namespace graspd::parts {

/// A mesh's triangles for kernels that test many at once: those that lie near each other in groups,
/// each group with a sphere around it. Part frame, metres.
struct TriangleGroups {
  static constexpr std::size_t kTriangles = 8;            ///< of a group
  static constexpr std::size_t kFloats = 9 * kTriangles;  ///< of a group's corners

  TriangleGroups() = default;
  explicit TriangleGroups(const Mesh& mesh);

  std::size_t size() const { return groups_n; }

  std::size_t groups_n = 0;
  /// Of each group the first corners' x, y and z, kTriangles values each, then the second and the
  /// third corners'. The last group repeats a triangle where there are too few.
  std::vector<float> corners_m;
  /// The groups' spheres, followed by kTriangles that nothing reaches, so that a kernel may load
  /// whole vectors.
  std::vector<float> x_m, y_m, z_m, radius_m;
};

}  // namespace graspd::parts
