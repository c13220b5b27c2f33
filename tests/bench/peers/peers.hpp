#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/perception/segmentation.hpp"

/// What people build bin picking from today, each library used as its own tutorials use it, with
/// parameters that were chosen on simulated frames of seeds 2000 and up. All get the points and
/// normals of graspd's default, perception::prepare_scene, which is in graspd's time and not in
/// theirs: on tuning frames they find as much on it as on perception::preprocess, or more. All work
/// on one core. For `./run bench perception` only.
namespace graspd::bench {

/// Eps and MinPts for every DBSCAN: the best on the tuning frames, of 4 to 6 mm and 5 to 13 points.
/// The defaults of the other methods were found so before.
perception::SegmentationParameters dbscan_parameters();

/// The textbook's DBSCAN, one neighbourhood query for each point as it is reached.
std::vector<perception::Indices> pcl_octree_dbscan(const perception::Cloud& cloud,
                                                   const perception::SegmentationParameters& with);
std::vector<perception::Indices> pcl_kdtree_dbscan(const perception::Cloud& cloud,
                                                   const perception::SegmentationParameters& with);
std::vector<perception::Indices> open3d_dbscan(const perception::Cloud& cloud,
                                               const perception::SegmentationParameters& with);

/// One instance of a part. A higher score is more certain, by the library's own measure.
struct ScoredPose {
  Eigen::Isometry3d T_camera_part = Eigen::Isometry3d::Identity();
  double score = 0;
};

/// From a cloud with normals to the instances of the one part that it was made for, which must
/// outlive it.
using PoseFinder = std::function<std::vector<ScoredPose>(const perception::Cloud&)>;

/// PCL's Euclidean clusters, each aligned coarsely and then by ICP; the score is the
/// negative of ICP's fitness score, a mean squared distance.
PoseFinder pcl_pca_icp(const parts::Part& part);
PoseFinder pcl_sac_ia_icp(const parts::Part& part);
PoseFinder pcl_ndt_icp(const parts::Part& part);
/// pcl::PPFRegistration answers one pose for a cloud: run on each Euclidean cluster, then ICP.
PoseFinder pcl_ppf_icp(const parts::Part& part);
/// PPF3DDetector on the whole cloud, then OpenCV's ICP; the score is the votes.
PoseFinder opencv_ppf_icp(const parts::Part& part);
/// Open3D's DBSCAN, FPFH with RANSAC, and ICP; the score is ICP's fitness.
PoseFinder open3d_fpfh_icp(const parts::Part& part);

/// The poses that the part may have in one cluster.
using ClusterPoses = std::function<std::vector<Eigen::Isometry3d>(const perception::Cloud&)>;

/// In each of PCL's Euclidean clusters the pose of best fitness, as ICP's getFitnessScore has it.
PoseFinder in_euclidean_clusters(const parts::Part& part, ClusterPoses method);

/// The points of one cluster, with their normals.
perception::Cloud subset(const perception::Cloud& cloud, const perception::Indices& indices);

/// The pose nearest to what averages of quaternions and products of floats have left of one.
Eigen::Isometry3d nearest_pose(const Eigen::Matrix4d& T);

/// The outside of the part, points about `spacing_m` apart, with normals. The bore of a pipe would
/// draw the points of its outside towards it, and cost every peer parts and time.
perception::Cloud model_cloud(const parts::Part& part, double spacing_m);

}  // namespace graspd::bench
