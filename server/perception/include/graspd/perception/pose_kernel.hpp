#pragma once

#include <cstddef>
#include <cstdint>

/// The inner loop of projective verification, on plain arrays, in the widest vectors that the
/// machine has.
namespace graspd::perception {

/// A depth image for the kernel. Each cell holds the reading at the pixel in its low 16 bits and
/// the nearest reading within one pixel in its high ones, both in tenths of a millimetre, 0 where
/// there is none. The outermost cells are 0.
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

/// Points in the part frame.
struct PointSpan {
  const float *x_m, *y_m, *z_m;  ///< 16 values beyond the last can be read
  std::size_t size;
};

/// What the image says of a pose's points.
struct PoseCounts {
  std::int32_t tested_n = 0;
  std::int32_t support_n = 0;  ///< a reading within tolerance at the point's pixel
  std::int32_t refute_n = 0;   ///< every reading within a pixel lies behind
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

}  // namespace graspd::perception
