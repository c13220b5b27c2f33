#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace graspd::perception {

/// Points in the camera's optical frame, metres, all finite. Normals point towards the camera.
struct Cloud {
  std::vector<Eigen::Vector3f> points_m;
  /// Unit length, one per point, or empty where not yet computed.
  std::vector<Eigen::Vector3f> normals;
  /// Surface variation λ₀ / (λ₀ + λ₁ + λ₂) of the neighbourhood, in [0, 1/3]; beside `normals`.
  std::vector<float> curvatures;

  std::size_t size() const { return points_m.size(); }
  bool empty() const { return points_m.empty(); }
};

/// Indices into a cloud, ascending.
using Indices = std::vector<std::uint32_t>;

}  // namespace graspd::perception
