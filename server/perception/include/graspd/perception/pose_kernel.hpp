#pragma once

#include <cstddef>
#include <cstdint>

/// The inner loop of projective verification, on plain arrays, in the widest vectors that the
/// machine has.
namespace graspd::perception {

/// A depth image for the kernel. Each cell holds the reading at the pixel in its low 16 bits and
/// the nearest reading within a few pixels in its high ones (DepthGrid::blur_px), both in tenths of
/// a millimetre. The low ones are 0 where no part can be (floor, walls), both where there is no
/// reading, as in the outermost cells.
struct PackedDepth {
  static constexpr float kUnit_m = 1e-4F;
  const std::uint32_t* cells = nullptr;
  int width_px = 0, height_px = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// T_camera_part: rotation, row by row, and translation.
struct KernelPose {
  float R[9];
  float t_m[3];
};

/// Points in the part frame. Of each array 16 values beyond the last can be read.
struct PointSpan {
  const float *x_m, *y_m, *z_m;
  std::size_t size;
};

/// What the image says of a pose's points.
struct PoseCounts {
  std::int32_t tested_n = 0;
  std::int32_t support_n = 0;  ///< a reading within tolerance at the point's pixel
  std::int32_t refute_n = 0;   ///< every reading near its pixel lies behind
  std::int32_t hidden_n = 0;   ///< the reading lies in front
  /// Of the supporting points: squares of the errors along the optical axis, in PackedDepth units.
  std::int32_t error2_sum = 0;
};

/// Stops after the first 16 points where fewer than `min_support_n` of them support the pose or
/// more than `max_refute_n` refute it.
struct EarlyStop {
  std::int32_t min_support_n = 0;
  std::int32_t max_refute_n = 16;
};

/// The counts do not depend on the vectors' width.
PoseCounts count_evidence(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                          float tolerance_m, const EarlyStop& stop = {});

/// Points with their normals.
struct SurfaceSpan {
  PointSpan points;
  const float *nx, *ny, *nz;
};

/// Projective point-to-plane ICP's normal equations A x = b over the points with a reading within
/// tolerance, with Tukey's weights. x: a turn about `centre_m`, times `radius_m`, then a shift, in
/// the camera frame.
struct NormalEquations {
  float A[21] = {};  ///< the upper triangle, row by row
  float b[6] = {};
  std::int32_t points_n = 0;
};
/// Camera frame. The radius makes turns as large as shifts.
struct TurnCentre {
  float centre_m[3];
  float radius_m;
};
NormalEquations icp_equations(const PackedDepth& depth, const KernelPose& pose,
                              const SurfaceSpan& surface, const TurnCentre& about,
                              float tolerance_m);

/// \param cells of each point the cell that it projects to; 0, which holds nothing, for the
/// outermost ones and beyond. \param z_m of each point in the camera frame. Both have room for the
/// points, rounded up to 16.
void project_points(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                    std::int32_t* cells, float* z_m);

/// What each supporting point counts: half of 1 − e² and half of 1 − small_error2 · e², where
/// that is above 0, for an error e in tolerances; less up to `normal` of it as the cosine between
/// its normal and the image's falls from agreeing to opposing.
struct SupportWeights {
  float tolerance_m;
  float small_error2;
  float normal;
  float agreeing_cosine, opposing_cosine;
};
/// \param normals of each cell, x, y, z; 0 where there is none.
/// \returns the sum of the weights.
float weigh_support(const PackedDepth& depth, const float* normals, const KernelPose& pose,
                    const SurfaceSpan& surface, const SupportWeights& weights);

}  // namespace graspd::perception
