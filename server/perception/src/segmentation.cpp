#include "graspd/perception/segmentation.hpp"

#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/region_growing.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "graspd/perception/dbscan.hpp"
#include "graspd/perception/grid_dbscan.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {
namespace {

/// Where Eps spans more pixels, as next to the lens, a tree is the faster way to the same clusters.
constexpr double kWidestWindow_px = 32;

std::vector<Indices> from_pcl(const std::vector<pcl::PointIndices>& clusters) {
  std::vector<Indices> result;
  for (const pcl::PointIndices& cluster : clusters) {
    result.emplace_back(cluster.indices.begin(), cluster.indices.end());
    std::sort(result.back().begin(), result.back().end());
  }
  // PCL sorts clusters by size, unstably.
  std::sort(result.begin(), result.end());
  return result;
}

Neighbourhoods kdtree_neighbourhoods(const Cloud& cloud, double radius_m) {
  const auto points = to_pcl(cloud);
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(points);
  Neighbourhoods result;
  result.offsets.push_back(0);
  pcl::Indices found;
  std::vector<float> distances2;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    tree.radiusSearch(static_cast<pcl::index_t>(i), radius_m, found, distances2);
    std::sort(found.begin(), found.end());
    result.indices.insert(result.indices.end(), found.begin(), found.end());
    result.offsets.push_back(static_cast<std::uint32_t>(result.indices.size()));
  }
  return result;
}

/// The side of a pixel of an organised cloud, at its points' mean depth.
double pixel_m(const Cloud& cloud) {
  double z_sum_m = 0;
  for (const auto& p : cloud.points_m) z_sum_m += static_cast<double>(p.z());
  const double f_px = std::sqrt(static_cast<double>(cloud.pixels.fx_px * cloud.pixels.fy_px));
  return z_sum_m / static_cast<double>(cloud.size()) / f_px;
}

/// To either side of the nearest point, what may be within Eps.
double widest_window_px(const Cloud& cloud, double eps_m) {
  double nearest_m = std::numeric_limits<double>::max();
  for (const auto& p : cloud.points_m) nearest_m = std::min(nearest_m, static_cast<double>(p.z()));
  const double f_px = static_cast<double>(std::max(cloud.pixels.fx_px, cloud.pixels.fy_px));
  return nearest_m > eps_m ? eps_m / (nearest_m - eps_m) * f_px
                           : std::numeric_limits<double>::max();
}

/// One point for each pixel or voxel of the half of its surface that a part shows at the most.
double points_shown(const parts::Part& part, double point_spacing_m) {
  return part.surface_area_m2 / 2 / (point_spacing_m * point_spacing_m);
}

}  // namespace

std::vector<Indices> improved_dbscan(const Cloud& cloud, const SegmentationParameters& parameters) {
  const Octree octree(cloud.points_m, parameters.octree_depth_n);
  const Neighbourhoods neighbourhoods = octree.neighbourhoods(static_cast<float>(parameters.eps_m));
  DbscanResult result = dbscan(cloud, neighbourhoods, parameters.min_points_n);
  merge_at_borders(cloud, neighbourhoods, parameters.smoothness_rad, parameters.curvature, result);
  return clusters_of(result);
}

std::vector<Indices> grid_dbscan(const Cloud& cloud, const SegmentationParameters& parameters) {
  if (!cloud.is_organised()) return improved_dbscan(cloud, parameters);
  const double eps_m = parameters.grid_eps_px * pixel_m(cloud);
  if (widest_window_px(cloud, eps_m) > kWidestWindow_px) {
    SegmentationParameters with = parameters;
    with.eps_m = eps_m;
    with.min_points_n = parameters.grid_min_points_n;
    return improved_dbscan(cloud, with);
  }
  const GridDbscan grid(cloud, static_cast<float>(eps_m), parameters.grid_min_points_n);
  DbscanResult result = grid.cluster();
  grid.merge_at_borders(parameters.smoothness_rad, parameters.curvature, result);
  return clusters_of(result);
}

std::vector<Indices> plain_dbscan(const Cloud& cloud, const SegmentationParameters& parameters) {
  if (cloud.empty()) return {};
  const Neighbourhoods neighbourhoods = kdtree_neighbourhoods(cloud, parameters.eps_m);
  return clusters_of(dbscan(cloud, neighbourhoods, parameters.min_points_n));
}

std::vector<Indices> euclidean_clusters(const Cloud& cloud,
                                        const SegmentationParameters& parameters) {
  if (cloud.empty()) return {};
  const auto points = to_pcl(cloud);
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(points);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(parameters.euclidean_tolerance_m);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(points);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  return from_pcl(clusters);
}

std::vector<Indices> region_growing(const Cloud& cloud, const SegmentationParameters& parameters) {
  if (cloud.empty()) return {};
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setSearchMethod(tree);
  growing.setNumberOfNeighbours(static_cast<unsigned>(parameters.region_neighbours_n));
  growing.setInputCloud(to_pcl(cloud));
  growing.setInputNormals(normals_to_pcl(cloud));
  growing.setSmoothnessThreshold(static_cast<float>(parameters.region_smoothness_rad));
  growing.setCurvatureThreshold(static_cast<float>(parameters.region_curvature));
  growing.setMinClusterSize(1);
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  return from_pcl(clusters);
}

SegmentationMethod segmentation_method(Segmentation name) {
  switch (name) {
    case Segmentation::kImprovedDbscan:
      return improved_dbscan;
    case Segmentation::kDbscan:
      return plain_dbscan;
    case Segmentation::kEuclidean:
      return euclidean_clusters;
    case Segmentation::kRegionGrowing:
      return region_growing;
    case Segmentation::kGridDbscan:
      return grid_dbscan;
    case Segmentation::kServerDefault:
      break;
  }
  throw std::invalid_argument("segmentation_method: no method is named");
}

std::vector<Indices> segment(const Cloud& cloud, std::span<const parts::Part* const> parts,
                             const PreprocessParameters& preprocess,
                             const SegmentationParameters& parameters) {
  const double spacing_m = cloud.is_organised() ? pixel_m(cloud) : preprocess.voxel_m;
  double fewest = std::numeric_limits<double>::max();
  for (const parts::Part* part : parts) fewest = std::min(fewest, points_shown(*part, spacing_m));
  std::vector<Indices> segments = segmentation_method(parameters.method)(cloud, parameters);
  std::erase_if(segments, [&](const Indices& one) {
    return static_cast<double>(one.size()) < fewest * parameters.min_segment_share;
  });
  return segments;
}

Eigen::Vector3d centroid_m(const Cloud& cloud, const Indices& segment) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : segment) sum_m += cloud.points_m[i].cast<double>();
  return sum_m / static_cast<double>(segment.size());
}

}  // namespace graspd::perception
