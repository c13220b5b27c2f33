#include "graspd/onboarding/decimate.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <map>

namespace graspd::onboarding {
namespace {

constexpr float kMaxErrorShare = 1e-3F;  ///< of the longest side

/// Collapses fold some triangles flat onto others of the same three corners. Each such pair is
/// taken out, which leaves as many triangles at every edge as there were before, but for pairs.
void remove_folds(std::vector<unsigned>& indices) {
  std::map<std::array<unsigned, 3>, std::size_t> once;  ///< corners to where they are in `indices`
  std::vector<bool> is_folded(indices.size() / 3);
  for (std::size_t i = 0; i < is_folded.size(); ++i) {
    std::array<unsigned, 3> corners{indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]};
    std::ranges::sort(corners);
    const auto [other, is_new] = once.emplace(corners, i);
    if (is_new) continue;
    is_folded[i] = is_folded[other->second] = true;
    once.erase(other);
  }
  std::size_t kept_n = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!is_folded[i / 3]) indices[kept_n++] = indices[i];
  }
  indices.resize(kept_n);
}

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
  remove_folds(fewer);
  return {compact(mesh, fewer),
          static_cast<double>(error * meshopt_simplifyScale(positions, vertices_n, kStride))};
}

}  // namespace graspd::onboarding
