#pragma once

#include <cstddef>
#include <cstdint>

/// Which points lie within Eps: the inner loops of DBSCAN. Plain arrays only: compiled once for
/// each instruction set. Each may read and write `kNeighbourPadding` values beyond an array's end.
/// Distances add up as Eigen's squaredNorm does, so that no rounding differs from elsewhere.
namespace graspd::perception {

inline constexpr std::size_t kNeighbourPadding = 64;

struct PointRows {
  const float *x_m, *y_m, *z_m;
};

/// Appends to `found` the ids of the points within reach of `p_m`. \returns their number.
std::size_t ids_within(const PointRows& points, const std::uint32_t* ids, std::size_t count,
                       const float p_m[3], float radius2_m2, std::uint32_t* found);

/// Neighbours of each point of a row of an image, among the points of a second image.
/// \param offsets to the pixels where they may be, at most 32.
/// \param masks bit t of each: whether there is one at offset t.
/// \param counts their numbers are added to these.
void mark_neighbours(const PointRows& row, const PointRows& others, std::size_t width,
                     const std::ptrdiff_t* offsets, std::size_t offsets_n, float radius2_m2,
                     std::uint32_t* masks, std::int32_t* counts);

}  // namespace graspd::perception
