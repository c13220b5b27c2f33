#include <algorithm>
#include <memory>
#include <opencv2/surface_matching/icp.hpp>
#include <opencv2/surface_matching/ppf_match_3d.hpp>

#include "peers.hpp"

namespace graspd::bench {
namespace {

using cv::ppf_match_3d::Pose3DPtr;

// Tried: steps of 0.05 to 0.12 for the model and 0.015 to 0.08 for the scene, every 5th to 20th
// point, 40 to 300 poses, 20 to 50 iterations. Finer ones take minutes a frame.
constexpr double kModelSpacing_m = 0.003;
constexpr double kModelStep = 0.1;  // of the part's size
constexpr double kDistanceStep = 0.05;
constexpr double kSceneStep = 0.015;  // of the cloud's size: about the same in metres
constexpr double kReferenceShare = 1.0 / 5;
constexpr std::size_t kRefinedPoses = 80;
constexpr std::size_t kMinVotes = 150;
constexpr int kIcpIterations = 20;
constexpr float kIcpTolerance = 0.005f;
constexpr float kIcpRejection = 2.5f;
constexpr int kIcpLevels = 2;
// OpenCV 4.6 averages the poses of a cluster, which it tells apart by their angle and not by their
// axis: clusters so narrow that little is averaged found three times as many parts.
constexpr double kSamePosition_m = 0.005;
constexpr double kSameRotation_rad = 0.1;

/// Rows of x, y, z, nx, ny, nz.
cv::Mat to_cv(const perception::Cloud& cloud) {
  cv::Mat rows(static_cast<int>(cloud.size()), 6, CV_32F);
  for (int i = 0; i < rows.rows; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      rows.at<float>(i, axis) = cloud.points_m[i][axis];
      rows.at<float>(i, 3 + axis) = cloud.normals[i][axis];
    }
  }
  return rows;
}

using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

Eigen::Isometry3d to_pose(const cv::Matx44d& matrix) {
  return nearest_pose(Eigen::Map<const Matrix>(matrix.val));
}

}  // namespace

PoseFinder opencv_ppf_icp(const parts::Part& part) {
  const cv::Mat model = to_cv(model_cloud(part, kModelSpacing_m));
  const auto detector =
      std::make_shared<cv::ppf_match_3d::PPF3DDetector>(kModelStep, kDistanceStep);
  detector->setSearchParams(kSamePosition_m, kSameRotation_rad);
  detector->trainModel(model);
  return [model, detector](const perception::Cloud& cloud) {
    const cv::Mat scene = to_cv(cloud);
    std::vector<Pose3DPtr> poses;
    detector->match(scene, poses, kReferenceShare, kSceneStep);
    poses.resize(std::min(poses.size(), kRefinedPoses));
    // What was averaged is no rotation, and ICP would keep it so.
    for (const Pose3DPtr& pose : poses) {
      Eigen::Map<Matrix>(pose->pose.val) = to_pose(pose->pose).matrix();
    }
    cv::ppf_match_3d::ICP icp(kIcpIterations, kIcpTolerance, kIcpRejection, kIcpLevels);
    if (!poses.empty()) icp.registerModelToScene(model, scene, poses);
    std::vector<ScoredPose> found;
    for (const Pose3DPtr& pose : poses) {
      if (pose->numVotes < kMinVotes) continue;
      found.push_back({to_pose(pose->pose), static_cast<double>(pose->numVotes)});
    }
    return found;
  };
}

}  // namespace graspd::bench
