#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace graspd::perception {

/// A pinhole image without distortion: neighbouring cells are neighbouring rays. Cell (u, v) has
/// the index v · width_px + u.
struct PixelGrid {
  int width_px = 0, height_px = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// Points in the camera's optical frame, metres, all finite. Normals point towards the camera.
struct Cloud {
  std::vector<Eigen::Vector3f> points_m;
  /// Unit length, one per point, or empty where not yet computed.
  std::vector<Eigen::Vector3f> normals;
  /// Surface variation λ₀ / (λ₀ + λ₁ + λ₂) of the neighbourhood, in [0, 1/3]; beside `normals`.
  std::vector<float> curvatures;
  /// Of an organised cloud, else empty: the cell of `pixels` whose ray each point lies on,
  /// ascending, one point to a cell.
  std::vector<std::uint32_t> cells;
  PixelGrid pixels;

  std::size_t size() const { return points_m.size(); }
  bool empty() const { return points_m.empty(); }
  bool is_organised() const { return !cells.empty(); }
};

/// Indices into a cloud, ascending.
using Indices = std::vector<std::uint32_t>;

}  // namespace graspd::perception
