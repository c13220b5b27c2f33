#include <pcl/features/ppf.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ppf_registration.h>
#include <pcl/search/kdtree.h>

#include <cmath>

#include "pcl_cloud.hpp"
#include "peers.hpp"

namespace graspd::bench {
namespace {

using Points = pcl::PointCloud<pcl::PointNormal>;

// Tried: spacings of 0.06 to 0.12 diameters, every point to every 20th, ICP distances of 5 to 20
// mm. A spacing of 0.06 takes ten times as long.
constexpr double kSpacingShare = 0.08;  // of the diameter, as of the steps of distance
constexpr unsigned kReferenceStep = 2;
// PCL 1.13 writes past the end of its votes where whole steps don't fill the circle: 29 do, as
// floats.
const auto kAngleStep_rad = static_cast<float>(2 * M_PI / 29);
constexpr float kSameRotation_rad = 0.35f;
constexpr double kIcpSpacing_m = 0.003;
constexpr double kIcpMaxDistance_m = 0.02;
constexpr int kIcpIterations = 30;

Points::Ptr with_normals(const perception::Cloud& cloud) {
  const Points::Ptr points(new Points);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& p = cloud.points_m[i];
    const auto& n = cloud.normals[i];
    points->emplace_back(p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
  return points;
}

Points::Ptr thinned(const Points::Ptr& points, float spacing_m) {
  pcl::VoxelGrid<pcl::PointNormal> grid;
  grid.setInputCloud(points);
  grid.setLeafSize(spacing_m, spacing_m, spacing_m);
  const Points::Ptr result(new Points);
  grid.filter(*result);
  for (auto& point : *result) point.getNormalVector3fMap().normalize();
  return result;
}

struct Model {
  float spacing_m = 0;
  Points::Ptr points;
  pcl::PPFHashMapSearch::Ptr search;
  pcl::PointCloud<pcl::PointXYZ>::Ptr surface;  ///< denser, for ICP
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree{new pcl::search::KdTree<pcl::PointXYZ>};
};

Model make_model(const parts::Part& part) {
  Model model;
  model.spacing_m = static_cast<float>(kSpacingShare * part.diameter_m);
  model.points = with_normals(model_cloud(part, model.spacing_m));
  pcl::PPFEstimation<pcl::PointNormal, pcl::PointNormal, pcl::PPFSignature> estimation;
  estimation.setInputCloud(model.points);
  estimation.setInputNormals(model.points);
  const pcl::PointCloud<pcl::PPFSignature>::Ptr features(new pcl::PointCloud<pcl::PPFSignature>);
  estimation.compute(*features);
  model.search.reset(new pcl::PPFHashMapSearch(kAngleStep_rad, model.spacing_m));
  model.search->setInputFeatureCloud(features);
  model.surface = perception::to_pcl(model_cloud(part, kIcpSpacing_m));
  model.tree->setInputCloud(model.surface);
  return model;
}

Eigen::Matrix4f matched(const perception::Cloud& cluster, const Model& model) {
  pcl::PPFRegistration<pcl::PointNormal, pcl::PointNormal> registration;
  registration.setSceneReferencePointSamplingRate(kReferenceStep);
  registration.setPositionClusteringThreshold(model.spacing_m);
  registration.setRotationClusteringThreshold(kSameRotation_rad);
  registration.setSearchMethod(model.search);
  registration.setInputSource(model.points);
  registration.setInputTarget(thinned(with_normals(cluster), model.spacing_m));
  Points aligned;
  registration.align(aligned);
  return registration.getFinalTransformation();
}

/// ICP of the cluster, which shows one side only, to the whole part.
std::vector<Eigen::Isometry3d> refined(const perception::Cloud& cluster, const Model& model,
                                       const Eigen::Matrix4f& T_camera_part) {
  if (!T_camera_part.allFinite()) return {};
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(perception::to_pcl(cluster));
  icp.setInputTarget(model.surface);
  icp.setSearchMethodTarget(model.tree, /*force_no_recompute=*/true);
  icp.setMaxCorrespondenceDistance(kIcpMaxDistance_m);
  icp.setMaximumIterations(kIcpIterations);
  pcl::PointCloud<pcl::PointXYZ> aligned;
  icp.align(aligned, T_camera_part.inverse());
  if (!icp.hasConverged()) return {};
  return {nearest_pose(icp.getFinalTransformation().inverse().cast<double>())};
}

}  // namespace

PoseFinder pcl_ppf_icp(const parts::Part& part) {
  return in_euclidean_clusters(part, [model = make_model(part)](const perception::Cloud& cluster) {
    return refined(cluster, model, matched(cluster, model));
  });
}

}  // namespace graspd::bench
