#include "graspd/onboarding/decimate.hpp"

#include <meshoptimizer.h>

namespace graspd::onboarding {
namespace {

constexpr float kMaxErrorShare = 1e-3F;  ///< of the longest side

/// Only the vertices that triangles have, in the order in which they have them.
parts::Mesh compact(const parts::Mesh& mesh, const std::vector<unsigned>& indices) {
  parts::Mesh smaller;
  std::vector<int> new_index(mesh.vertices_m.size(), -1);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      int& index = new_index[indices[i + k]];
      if (index < 0) {
        index = static_cast<int>(smaller.vertices_m.size());
        smaller.vertices_m.push_back(mesh.vertices_m[indices[i + k]]);
      }
      triangle[k] = index;
    }
    smaller.triangles.push_back(triangle);
  }
  return smaller;
}

}  // namespace

Decimated decimate(const parts::Mesh& mesh, std::size_t triangles_n) {
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) indices.push_back(static_cast<unsigned>(index));
  }
  const float* const positions = mesh.vertices_m.front().data();
  const std::size_t vertices_n = mesh.vertices_m.size();
  constexpr std::size_t kStride = sizeof(Eigen::Vector3f);
  float error = 0;
  std::vector<unsigned> fewer(indices.size());
  fewer.resize(meshopt_simplify(fewer.data(), indices.data(), indices.size(), positions, vertices_n,
                                kStride, 3 * triangles_n, kMaxErrorShare, 0, &error));
  return {compact(mesh, fewer),
          static_cast<double>(error * meshopt_simplifyScale(positions, vertices_n, kStride))};
}

}  // namespace graspd::onboarding
