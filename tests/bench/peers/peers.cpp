#include "peers.hpp"

#include <Eigen/SVD>
#include <algorithm>

namespace graspd::bench {

perception::SegmentationParameters dbscan_parameters() {
  perception::SegmentationParameters parameters;
  parameters.eps_m = 0.004;
  parameters.min_points_n = 7;
  return parameters;
}

perception::Cloud subset(const perception::Cloud& cloud, const perception::Indices& indices) {
  perception::Cloud points;
  for (const std::uint32_t i : indices) {
    points.points_m.push_back(cloud.points_m[i]);
    points.normals.push_back(cloud.normals[i]);
    points.curvatures.push_back(cloud.curvatures[i]);
  }
  return points;
}

Eigen::Isometry3d nearest_pose(const Eigen::Matrix4d& T) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(T.topLeftCorner<3, 3>(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = U * svd.matrixV().transpose();
  pose.translation() = T.topRightCorner<3, 1>();
  return pose;
}

perception::Cloud model_cloud(const parts::Part& part, double spacing_m) {
  const auto surface = parts::sample_surface(part.mesh, spacing_m);
  const auto aside_m = static_cast<float>(spacing_m);
  const auto faces = [&](const parts::SurfacePoint& from, const parts::SurfacePoint& to) {
    const Eigen::Vector3f d = to.position_m - from.position_m;
    const float ahead_m = d.dot(from.normal);
    return ahead_m > aside_m && (d - ahead_m * from.normal).norm() < aside_m;
  };
  perception::Cloud model;
  for (const parts::SurfacePoint& point : surface) {
    const bool is_inside = std::any_of(surface.begin(), surface.end(),
                                       [&](const auto& other) { return faces(point, other); });
    if (is_inside) continue;
    model.points_m.push_back(point.position_m);
    model.normals.push_back(point.normal);
    model.curvatures.push_back(0);
  }
  return model;
}

}  // namespace graspd::bench
