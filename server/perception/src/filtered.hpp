#pragma once

#include <algorithm>
#include <iterator>

#include "graspd/perception/cloud.hpp"

namespace graspd::perception {

/// The points that `keep` says yes to, without normals.
template <class Keep>
Cloud filtered(const Cloud& cloud, Keep keep) {
  Cloud kept;
  kept.points_m.reserve(cloud.size());
  std::copy_if(cloud.points_m.begin(), cloud.points_m.end(), std::back_inserter(kept.points_m),
               keep);
  return kept;
}

}  // namespace graspd::perception
