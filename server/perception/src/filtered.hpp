#pragma once

#include "graspd/perception/cloud.hpp"

namespace graspd::perception {

/// The points that `keep` says yes to, without normals; what was organised stays so.
template <class Keep>
Cloud filtered(const Cloud& cloud, Keep keep) {
  Cloud kept;
  kept.pixels = cloud.pixels;
  kept.points_m.reserve(cloud.size());
  kept.cells.reserve(cloud.cells.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!keep(cloud.points_m[i])) continue;
    kept.points_m.push_back(cloud.points_m[i]);
    if (cloud.is_organised()) kept.cells.push_back(cloud.cells[i]);
  }
  return kept;
}

}  // namespace graspd::perception
