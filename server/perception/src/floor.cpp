#include "graspd/perception/floor.hpp"

#include <pcl/segmentation/sac_segmentation.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "filtered.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {
namespace {

constexpr double kFloorTilt_rad = 15 * M_PI / 180;

/// A floor's own coordinates: a grid of cells on the plane.
class FloorGrid {
 public:
  FloorGrid(const Plane& floor, const Cloud& cloud)
      : x_(floor.normal.unitOrthogonal()), y_(floor.normal.cross(x_)) {
    for (const auto& p : cloud.points_m) {
      box_.extend(Eigen::Vector2f(p.dot(x_), p.dot(y_)));
    }
  }
  cv::Point cell(const Eigen::Vector3f& p) const {
    const Eigen::Vector2f at = (Eigen::Vector2f(p.dot(x_), p.dot(y_)) - box_.min()) / kCell_m;
    return {static_cast<int>(at.x()), static_cast<int>(at.y())};
  }
  cv::Size size() const {
    const Eigen::Vector2f size = box_.sizes() / kCell_m;
    return {static_cast<int>(size.x()) + 1, static_cast<int>(size.y()) + 1};
  }
  static constexpr float kCell_m = 0.006f;

 private:
  Eigen::Vector3f x_, y_;
  Eigen::AlignedBox2f box_;
};

}  // namespace

std::optional<Plane> find_floor(const Cloud& cloud, const std::optional<Eigen::Vector3f>& up_camera,
                                const PreprocessParameters& parameters) {
  if (cloud.size() < 3) return std::nullopt;
  pcl::SACSegmentation<pcl::PointXYZ> ransac(/*random=*/false);
  ransac.setModelType(up_camera ? pcl::SACMODEL_PERPENDICULAR_PLANE : pcl::SACMODEL_PLANE);
  if (up_camera) {
    ransac.setAxis(*up_camera);
    ransac.setEpsAngle(kFloorTilt_rad);
  }
  ransac.setMethodType(pcl::SAC_RANSAC);
  ransac.setMaxIterations(parameters.plane_iterations_n);
  ransac.setDistanceThreshold(parameters.plane_tolerance_m);
  ransac.setInputCloud(to_pcl(cloud));
  pcl::PointIndices inliers;
  pcl::ModelCoefficients coefficients;
  ransac.segment(inliers, coefficients);
  const auto count = static_cast<double>(cloud.size());
  if (static_cast<double>(inliers.indices.size()) < parameters.plane_min_share * count) {
    return std::nullopt;
  }
  Plane plane{{coefficients.values[0], coefficients.values[1], coefficients.values[2]},
              coefficients.values[3]};
  if (plane.offset_m < 0) plane = {-plane.normal, -plane.offset_m};  // the camera is above it
  const auto behind_n =
      std::count_if(cloud.points_m.begin(), cloud.points_m.end(), [&](const Eigen::Vector3f& p) {
        return plane.height_m(p) < -2 * parameters.plane_tolerance_m;
      });
  if (static_cast<double>(behind_n) > parameters.max_behind_plane_share * count) {
    return std::nullopt;
  }
  return plane;
}

Cloud above_plane(const Cloud& cloud, const Plane& plane, double max_height_m,
                  const PreprocessParameters& parameters) {
  return filtered(cloud, [&](const Eigen::Vector3f& p) {
    const float height_m = plane.height_m(p);
    return height_m > parameters.plane_tolerance_m && height_m <= max_height_m;
  });
}

Cloud over_floor(const Cloud& cloud, const Cloud& all, const Plane& floor,
                 const PreprocessParameters& parameters) {
  const FloorGrid grid(floor, all);
  cv::Mat seen = cv::Mat::zeros(grid.size(), CV_8UC1);
  for (const auto& p : all.points_m) {
    if (std::abs(floor.height_m(p)) <= parameters.plane_tolerance_m)
      seen.at<uchar>(grid.cell(p)) = 1;
  }
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(seen, labels, stats, centroids);
  int largest = 1;
  for (int label = 2; label < count; ++label) {
    const auto area = [&](int of) { return stats.at<int>(of, cv::CC_STAT_AREA); };
    if (area(label) > area(largest)) largest = label;
  }
  std::vector<cv::Point> cells, hull;
  cv::findNonZero(labels == largest, cells);
  cv::convexHull(cells, hull);
  return filtered(cloud, [&](const Eigen::Vector3f& p) {
    const double inside_cells = cv::pointPolygonTest(hull, cv::Point2f(grid.cell(p)), true);
    return inside_cells * FloorGrid::kCell_m >= parameters.wall_margin_m;
  });
}

}  // namespace graspd::perception
