#pragma once

#include <cstdint>
#include <vector>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/octree.hpp"

namespace graspd::perception {

inline constexpr std::int32_t kNoise = -1;

/// Clusters by the paper's Definition 4 (Ester et al. 1996).
struct DbscanResult {
  std::vector<std::int32_t> labels;  ///< per point: its cluster from 0, or kNoise
  std::vector<bool> is_core;
  std::int32_t clusters_n = 0;
};

/// A core point has at least `min_points_n` points within Eps, itself included. Clusters are
/// numbered by their first core point. A border point reachable from several clusters, which
/// Definition 4 leaves open, goes to that of its nearest core point.
DbscanResult dbscan(const Cloud& cloud, const Neighbourhoods& neighbourhoods, int min_points_n);

/// Lines 6 to 8 of the paper's Algorithm 1: each border point looks for the core point in reach
/// whose Eps-neighbourhood has most in common with its own, and merges its cluster into that
/// point's where the normals differ by less than θ_th and the curvatures by less than c_th.
/// \param cloud with normals and curvatures.
void merge_at_borders(const Cloud& cloud, const Neighbourhoods& neighbourhoods,
                      double smoothness_rad, double curvature, DbscanResult& result);

/// The points of each cluster.
std::vector<Indices> clusters_of(const DbscanResult& result);

}  // namespace graspd::perception
