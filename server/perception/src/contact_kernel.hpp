#pragma once

#include <cstddef>
#include <cstdint>

#include "graspd/perception/pose_kernel.hpp"

/// The inner loop of the search for contacts, on plain arrays. Internal to perception.
namespace graspd::perception {

/// Of parts::SphereArrays, those from `first` on.
struct SphereSpan {
  const float *x_m, *y_m, *z_m, *radius_m;
  std::uint32_t first;
  std::uint32_t size;
};

/// parts::DistanceGrid, for the kernel.
struct DistanceSpan {
  const float* distance_m;
  float origin_m[3];
  std::int32_t size[3];
  float cells_per_m;
};

/// Indices of spheres, with room for the whole vectors that the kernel writes.
struct SphereIndices {
  static constexpr std::uint32_t kMost = 64;
  std::uint32_t values[kMost + 16];
};

/// Which of at most SphereIndices::kMost spheres may be within `distance_m` of the grid's template,
/// in rising order; never leaves out one that is. \returns how many.
std::size_t find_spheres_near(const SphereSpan& spheres, const KernelPose& T_grid_sphere,
                              const DistanceSpan& grid, float distance_m, SphereIndices& near);

}  // namespace graspd::perception
