#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/pose_kernel.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::perception {

/// The organised path: the part of a depth frame in which parts may lie, without lens distortion
/// and stray light. A pinhole image, so that neighbouring cells are neighbouring rays; its
/// outermost cells hold nothing.
struct DepthGrid {
  int width_px = 0, height_px = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::vector<float> z_m;                ///< 0: no reading
  std::vector<Eigen::Vector3f> normals;  ///< towards the camera; 0 where there is none
  std::vector<std::uint8_t> is_part;     ///< 1 for what may be a part: neither floor nor wall
  std::vector<std::uint8_t> is_claimed;  ///< 1 for what an accepted part explains
  std::vector<std::uint32_t> packed;     ///< see PackedDepth; claimed cells hide what is behind

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
           static_cast<std::size_t>(u);
  }
  /// Not among the outermost cells.
  bool contains(int u, int v) const {
    return u >= 1 && v >= 1 && u < width_px - 1 && v < height_px - 1;
  }
  Eigen::Vector3f point_m(int u, int v) const;
  /// The cell that a point projects to, or the number of cells where that is none.
  std::size_t cell_of(const Eigen::Vector3f& p_m) const;
  PackedDepth for_kernel() const {
    return {packed.data(), width_px, height_px, fx_px, fy_px, cx_px, cy_px};
  }
  /// Whether a reading is there that no accepted part explains.
  bool is_open(std::size_t cell) const { return z_m[cell] > 0 && is_claimed[cell] == 0; }

  /// Marks cells as explained. They support and refute no other pose.
  void claim(const std::vector<std::size_t>& cells);
};

/// \param parts_cloud what lies above the floor: the grid covers it, with a margin.
DepthGrid make_depth_grid(const DepthFrame& frame, const Cloud& parts_cloud,
                          const PreprocessParameters& parameters);

/// Takes out the light that lens and scene scatter into each pixel from its surroundings: a
/// reading is the mean of a pixel's own light and of `stray_light_share` of its surroundings',
/// weighted by brightness, cos²(incidence) / z². Without it, piles look flatter than they are.
void remove_stray_light(const PreprocessParameters& parameters, int width_px, int height_px,
                        double f_px, std::vector<float>& z_m);

}  // namespace graspd::perception
