#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/CorrespondenceChecker.h>
#include <open3d/pipelines/registration/Feature.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/utility/Logging.h>
#include <open3d/utility/Random.h>

#include <algorithm>
#include <memory>

#include "peers.hpp"

namespace graspd::bench {
namespace {

using open3d::geometry::PointCloud;
namespace registration = open3d::pipelines::registration;

// Tried: radii of 12 to 25 mm, distances of 4 to 8 mm, 10,000 to 50,000 iterations, mutual matches,
// ICP to points.
constexpr double kModelSpacing_m = 0.003;
constexpr std::size_t kMinClusterPoints = 100;
constexpr double kFeatureRadius_m = 0.02;
constexpr int kFeatureNeighbours = 100;
constexpr double kSameDistance_m = 0.007;
constexpr double kSameEdgeLength = 0.9;
constexpr int kIterations = 50000;
constexpr double kConfidence = 0.999;
constexpr int kMatchesOfDraw = 3;

PointCloud to_open3d(const perception::Cloud& cloud) {
  PointCloud points;
  for (const auto& p : cloud.points_m) points.points_.push_back(p.cast<double>());
  for (const auto& n : cloud.normals) points.normals_.push_back(n.cast<double>());
  return points;
}

/// A cloud and its FPFH features.
struct Described {
  PointCloud points;
  std::shared_ptr<registration::Feature> features;
};

Described describe(const perception::Cloud& cloud) {
  Described described{to_open3d(cloud), {}};
  described.features = registration::ComputeFPFHFeature(
      described.points,
      open3d::geometry::KDTreeSearchParamHybrid(kFeatureRadius_m, kFeatureNeighbours));
  return described;
}

/// The global registration of Open3D's tutorial, then ICP to the part's planes.
registration::RegistrationResult align(const Described& cluster, const Described& model) {
  const registration::CorrespondenceCheckerBasedOnEdgeLength edges(kSameEdgeLength);
  const registration::CorrespondenceCheckerBasedOnDistance distance(kSameDistance_m);
  const auto coarse = registration::RegistrationRANSACBasedOnFeatureMatching(
      cluster.points, model.points, *cluster.features, *model.features, /*mutual_filter=*/false,
      kSameDistance_m, registration::TransformationEstimationPointToPoint(), kMatchesOfDraw,
      {edges, distance}, {kIterations, kConfidence});
  return registration::RegistrationICP(cluster.points, model.points, kSameDistance_m,
                                       coarse.transformation_,
                                       registration::TransformationEstimationPointToPlane());
}

}  // namespace

std::vector<perception::Indices> open3d_dbscan(const perception::Cloud& cloud,
                                               const perception::SegmentationParameters& with) {
  const std::vector<int> labels =
      to_open3d(cloud).ClusterDBSCAN(with.eps_m, static_cast<std::size_t>(with.min_points_n));
  const int last = labels.empty() ? -1 : *std::max_element(labels.begin(), labels.end());
  std::vector<perception::Indices> clusters(static_cast<std::size_t>(last + 1));
  for (std::uint32_t i = 0; i < labels.size(); ++i) {
    if (labels[i] >= 0) clusters[labels[i]].push_back(i);
  }
  return clusters;
}

PoseFinder open3d_fpfh_icp(const parts::Part& part) {
  open3d::utility::Logger::GetInstance().SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  return [model = describe(model_cloud(part, kModelSpacing_m))](const perception::Cloud& cloud) {
    open3d::utility::random::Seed(1);
    std::vector<ScoredPose> found;
    for (const auto& indices : open3d_dbscan(cloud, dbscan_parameters())) {
      if (indices.size() < kMinClusterPoints) continue;
      const auto result = align(describe(subset(cloud, indices)), model);
      if (result.fitness_ <= 0) continue;
      found.push_back({nearest_pose(result.transformation_.inverse()), result.fitness_});
    }
    return found;
  };
}

}  // namespace graspd::bench
