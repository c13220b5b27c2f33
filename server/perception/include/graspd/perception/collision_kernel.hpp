#pragma once

#include <cstddef>

#include "graspd/perception/pose_kernel.hpp"

/// The inner loops of the collision checks, on plain arrays, in vectors of up to eight.
namespace graspd::perception {

/// A box about the origin of its own frame.
struct KernelBox {
  float half_m[3];
};

/// parts::TriangleGroups, for the kernel.
struct TriangleSpan {
  const float* corners_m;
  const float *x_m, *y_m, *z_m, *radius_m;
  std::size_t groups_n;
};

/// Whether a triangle reaches into the box (Akenine-Möller's separating axes). Exact: a surface
/// that only touches a face does not reach into it. A box that lies wholly inside a solid meets
/// none of its triangles.
bool meets_surface(const KernelBox& box, const KernelPose& T_box_part,
                   const TriangleSpan& triangles);

/// How far the ray of each pixel is known to be free: up to a depth, along the optical axis, in
/// metres. Rows and tiles are whole: width and height are multiples of kTile.
struct FreeDepth {
  static constexpr int kTile = 8;
  const float* free_m;
  const float* tile_free_m;  ///< at most the least of each tile of kTile × kTile pixels
  int width_px = 0, height_px = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// Tiles of the image, from first to before last.
struct TileBox {
  int u_first = 0, v_first = 0, u_last = 0, v_last = 0;
};

/// Whether the ray of some pixel is in the box beyond its free depth and a tolerance: that there is
/// something in the box, or that nobody can say. Every pixel's ray is cut with the box, so that
/// nothing slips between samples.
/// \param T_box_camera camera to box. \param deepest_m of the box's corners, along the optical
/// axis.
bool meets_unseen(const FreeDepth& image, const KernelBox& box, const KernelPose& T_box_camera,
                  const TileBox& tiles, float deepest_m, float tolerance_m);

}  // namespace graspd::perception
