#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/pose_kernel.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::perception {

/// The part of a depth frame in which parts may lie, without lens distortion. A pinhole image, so
/// that neighbouring cells are neighbouring rays; its outermost cells hold nothing.
struct DepthGrid {
  int width_px = 0, height_px = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  int blur_px = 1;                       ///< by which silhouettes of parts may be smeared
  std::vector<float> z_m;                ///< 0: no reading
  std::vector<Eigen::Vector3f> normals;  ///< towards the camera; 0 where there is none
  std::vector<float> curvatures;         ///< as of a Cloud
  std::vector<std::uint8_t> is_part;     ///< 1 for what may be a part: neither floor nor wall
  std::vector<std::uint8_t> is_claimed;  ///< 1 for what an accepted part explains
  std::vector<std::uint32_t> packed;     ///< see PackedDepth; claimed cells hide what is behind

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
           static_cast<std::size_t>(u);
  }
  std::size_t size() const { return z_m.size(); }
  PixelGrid pixels() const { return {width_px, height_px, fx_px, fy_px, cx_px, cy_px}; }
  /// Not among the outermost cells.
  bool contains(int u, int v) const {
    return u >= 1 && v >= 1 && u < width_px - 1 && v < height_px - 1;
  }
  /// Of a reading, in the camera's optical frame.
  Eigen::Vector3f point_m(int u, int v) const;
  /// The cell that a point projects to, or the number of cells where that is none.
  std::size_t cell_of(const Eigen::Vector3f& p_m) const;
  PackedDepth for_kernel() const {
    return {packed.data(), width_px, height_px, fx_px, fy_px, cx_px, cy_px};
  }
  /// Whether a reading is there that no accepted part explains.
  bool is_open(std::size_t cell) const { return (z_m[cell] > 0) & (is_claimed[cell] == 0); }

  /// Whether that reading may be a part's.
  bool can_support(std::size_t cell) const { return is_open(cell) && is_part[cell] != 0; }

  /// What lies there is no part after all.
  void take_for_floor(std::size_t cell);
  /// Marks cells as explained. They support and refute no other pose.
  void claim(const std::vector<std::uint32_t>& cells);
};

/// Cells of a pinhole image, both ends among them; none where the last is below the first.
struct CellBox {
  int u_first = 0, v_first = 0, u_last = -1, v_last = -1;
};

/// The cells that the points lie in, with a margin: readings there refute poses that reach beyond.
CellBox box_around(const Cloud& cloud, const PixelGrid& image);

/// The readings in range, in metres; 0 for the others. As wide and high as the frame, and distorted
/// as it is.
std::vector<float> readings_m(const DepthFrame& frame, const PreprocessParameters& parameters);

/// The readings of a box of the undistorted image; nothing else of the grid is set yet.
DepthGrid cut_out_readings(const CameraIntrinsics& camera, const std::vector<float>& z_m,
                           const CellBox& box);

/// The same box of a grid.
DepthGrid cut_out_readings(const DepthGrid& image, const CellBox& box);

/// By how much the sensor's smoothing must be undone, from 0 for none: from how alike the noise of
/// neighbouring readings is. White noise says that nothing smoothed it.
float sharpening_gain(const DepthGrid& grid);

/// Unsharp masking where there are edges, by `sharpening_gain`. A smoothed edge is a ramp of
/// readings where there is no surface, and takes a small part half of its own.
void sharpen_edges(DepthGrid& grid);

/// Where parts are, and with that what poses are compared with: `is_part`, `blur_px` and `packed`.
/// \param parts_cloud what lies above the floor.
void mark_parts(const Cloud& parts_cloud, DepthGrid& grid);

/// `packed` anew, after readings have changed.
void pack(DepthGrid& grid);

/// Normals and curvatures of the grid's readings.
void fit_normals(DepthGrid& grid);

/// All of the above.
DepthGrid make_depth_grid(const DepthFrame& frame, const Cloud& parts_cloud,
                          const PreprocessParameters& parameters);

}  // namespace graspd::perception
