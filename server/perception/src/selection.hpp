#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace graspd::perception {

/// Where a part is.
struct Place {
  Eigen::Vector3f barycentre_m;
  float reach_m;  ///< no other part's barycentre can be nearer
};

/// Whether there is no room for two parts there.
inline bool is_same_place(const Place& a, const Place& b) {
  return (a.barycentre_m - b.barycentre_m).norm() < std::min(a.reach_m, b.reach_m);
}

/// A pose that the image allows, as if it were alone.
struct Candidate {
  Place place;
  float area_m2;                         ///< of the image's surface that it explains
  float cell_m2;                         ///< of that surface, to a reading
  std::span<const std::uint32_t> cells;  ///< the readings that support it
};

/// The candidates that together explain most of the image. A reading that several of them explain
/// counts once and costs the others more than they gain by it, so that one pose across two parts
/// gives way to the two. Found by adding what gains most until nothing does, then by taking each
/// out again and explaining its readings in another way, while that explains more.
/// \param cells_n of the image. \returns indices, ascending.
std::vector<std::uint32_t> choose_explanation(std::span<const Candidate> candidates,
                                              std::size_t cells_n);

}  // namespace graspd::perception
