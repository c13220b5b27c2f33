#include <pcl/octree/octree_search.h>
#include <pcl/search/kdtree.h>

#include <deque>

#include "pcl_cloud.hpp"
#include "peers.hpp"

namespace graspd::bench {
namespace {

constexpr int kUnseen = -2;
constexpr int kNoise = -1;
constexpr double kLeafOverEps = 5;  // the fastest of 0.5 to 8

/// Ester et al. 1996. `neighbours_of(i, found)` answers the points within Eps of point i.
template <class NeighboursOf>
std::vector<perception::Indices> dbscan(std::size_t points_n, std::size_t min_points_n,
                                        NeighboursOf neighbours_of) {
  std::vector<int> labels(points_n, kUnseen);
  std::vector<perception::Indices> clusters;
  pcl::Indices found;
  for (std::size_t seed = 0; seed < points_n; ++seed) {
    if (labels[seed] != kUnseen) continue;
    neighbours_of(seed, found);
    if (found.size() < min_points_n) {
      labels[seed] = kNoise;
      continue;
    }
    const int cluster = static_cast<int>(clusters.size());
    clusters.emplace_back();
    labels[seed] = cluster;
    std::deque<pcl::index_t> queue(found.begin(), found.end());
    while (!queue.empty()) {
      const pcl::index_t i = queue.front();
      queue.pop_front();
      if (labels[i] >= 0) continue;
      const bool was_noise = labels[i] == kNoise;
      labels[i] = cluster;
      if (was_noise) continue;
      neighbours_of(i, found);
      if (found.size() >= min_points_n) queue.insert(queue.end(), found.begin(), found.end());
    }
  }
  for (std::uint32_t i = 0; i < points_n; ++i) {
    if (labels[i] >= 0) clusters[labels[i]].push_back(i);
  }
  return clusters;
}

}  // namespace

std::vector<perception::Indices> pcl_octree_dbscan(const perception::Cloud& cloud,
                                                   const perception::SegmentationParameters& with) {
  pcl::octree::OctreePointCloudSearch<pcl::PointXYZ> octree(kLeafOverEps * with.eps_m);
  octree.setInputCloud(perception::to_pcl(cloud));
  octree.addPointsFromInputCloud();
  std::vector<float> distances2;
  return dbscan(cloud.size(), static_cast<std::size_t>(with.min_points_n),
                [&](std::size_t i, pcl::Indices& found) {
                  octree.radiusSearch(static_cast<pcl::uindex_t>(i), with.eps_m, found, distances2);
                });
}

std::vector<perception::Indices> pcl_kdtree_dbscan(const perception::Cloud& cloud,
                                                   const perception::SegmentationParameters& with) {
  pcl::search::KdTree<pcl::PointXYZ> tree(/*sorted=*/false);
  tree.setInputCloud(perception::to_pcl(cloud));
  std::vector<float> distances2;
  return dbscan(cloud.size(), static_cast<std::size_t>(with.min_points_n),
                [&](std::size_t i, pcl::Indices& found) {
                  tree.radiusSearch(static_cast<pcl::index_t>(i), with.eps_m, found, distances2);
                });
}

}  // namespace graspd::bench
