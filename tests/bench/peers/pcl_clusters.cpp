#include <pcl/search/kdtree.h>

#include <utility>

#include "graspd/perception/registration.hpp"
#include "pcl_cloud.hpp"
#include "peers.hpp"

namespace graspd::bench {
namespace {

// Tried: shares of 0.05 to 0.2, ICP distances of 5 to 30 mm, 30 and 50 iterations, 200 and 400
// draws for SAC-IA, Euclidean tolerances of 2.4 to 4 mm: 3.4 mm finds as much as the default, in
// twice the time. The rest of registration's defaults were found so before.
constexpr double kMinClusterShare = 0.15;  // of the points that the whole part would show
constexpr double kMaxFitness_m2 = 8e-6;    // a looser one lets in far more wrong poses than right
constexpr double kIcpMaxDistance_m = 0.02;
constexpr int kIcpIterations = 30;
constexpr double kSurfaceSpacing_m = 0.002;

/// What pcl::Registration::getFitnessScore answers for a cluster registered to the part: the mean
/// squared distance from the cluster's points to the surface.
class Fitness {
 public:
  explicit Fitness(const parts::Part& part) {
    tree_.setInputCloud(perception::to_pcl(model_cloud(part, kSurfaceSpacing_m)));
  }
  double of(const perception::Cloud& cluster, const Eigen::Isometry3d& T_camera_part) const {
    const Eigen::Isometry3f T_part_camera = T_camera_part.inverse().cast<float>();
    pcl::Indices nearest(1);
    std::vector<float> distance2(1);
    double sum_m2 = 0;
    for (const auto& p_camera : cluster.points_m) {
      const Eigen::Vector3f p = T_part_camera * p_camera;
      tree_.nearestKSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), 1, nearest, distance2);
      sum_m2 += distance2[0];
    }
    return sum_m2 / static_cast<double>(cluster.size());
  }

 private:
  pcl::search::KdTree<pcl::PointXYZ> tree_;
};

PoseFinder with_method(const parts::Part& part, Registration name) {
  perception::RegistrationParameters parameters;
  parameters.icp_max_distance_m = kIcpMaxDistance_m;
  parameters.icp_iterations_n = kIcpIterations;
  const parts::Part* const parts[] = {&part};
  return in_euclidean_clusters(
      part, [method = perception::registration_method(name, parts, parameters)](
                const perception::Cloud& cluster) { return method(cluster, 0); });
}

}  // namespace

PoseFinder in_euclidean_clusters(const parts::Part& part, ClusterPoses method) {
  return
      [&part, method = std::move(method), fitness = Fitness(part)](const perception::Cloud& cloud) {
        perception::SegmentationParameters clustering;
        clustering.method = Segmentation::kEuclidean;
        clustering.min_segment_share = kMinClusterShare;
        const parts::Part* const parts[] = {&part};
        std::vector<ScoredPose> found;
        for (const auto& indices : perception::segment(cloud, parts, {}, clustering)) {
          const perception::Cloud cluster = subset(cloud, indices);
          ScoredPose best{Eigen::Isometry3d::Identity(), -kMaxFitness_m2};
          for (const Eigen::Isometry3d& T_camera_part : method(cluster)) {
            const double score = -fitness.of(cluster, T_camera_part);
            if (score > best.score) best = {T_camera_part, score};
          }
          if (best.score > -kMaxFitness_m2) found.push_back(best);
        }
        return found;
      };
}

PoseFinder pcl_pca_icp(const parts::Part& part) { return with_method(part, Registration::kPcaIcp); }
PoseFinder pcl_sac_ia_icp(const parts::Part& part) {
  return with_method(part, Registration::kSacIaIcp);
}
PoseFinder pcl_ndt_icp(const parts::Part& part) { return with_method(part, Registration::kNdtIcp); }

}  // namespace graspd::bench
