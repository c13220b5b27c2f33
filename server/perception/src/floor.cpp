#include "graspd/perception/floor.hpp"

#include <pcl/segmentation/sac_segmentation.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "filtered.hpp"
#include "pcl_cloud.hpp"

namespace graspd::perception {
namespace {

constexpr double kFloorTilt_rad = 15 * M_PI / 180;
constexpr std::size_t kSample = 1500;  ///< RANSAC needs no more, whatever the size of the image
constexpr int kPlaneRefinements = 8;

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

/// Whether nearly enough points lie on the plane, and next to none behind it.
std::optional<Plane> if_floor(const Cloud& cloud, Plane plane, std::size_t inliers_n,
                              const PreprocessParameters& parameters) {
  const auto count = static_cast<double>(cloud.size());
  if (static_cast<double>(inliers_n) < parameters.plane_min_share * count) return std::nullopt;
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

/// And a plane at all: points in a line have none, and leave the normal 0.
bool is_upright(const Plane& plane, const std::optional<Eigen::Vector3f>& up_camera) {
  static const auto kMinCosine = static_cast<float>(std::cos(kFloorTilt_rad));
  return plane.normal.squaredNorm() > 0.5F &&
         (!up_camera || std::abs(plane.normal.dot(*up_camera)) >= kMinCosine);
}

/// Every n-th point of a cloud, as the compiler's vectors want them.
class SampledPoints {
 public:
  SampledPoints(const Cloud& cloud, std::size_t step) {
    for (std::size_t i = 0; i < cloud.size(); i += step) {
      x_m_.push_back(cloud.points_m[i].x());
      y_m_.push_back(cloud.points_m[i].y());
      z_m_.push_back(cloud.points_m[i].z());
    }
  }
  std::size_t size() const { return x_m_.size(); }
  Eigen::Vector3f at(std::size_t i) const { return {x_m_[i], y_m_[i], z_m_[i]}; }

  int count_within(const Plane& plane, float tolerance_m) const {
    const float a = plane.normal.x(), b = plane.normal.y(), c = plane.normal.z();
    int count = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const float height_m = a * x_m_[i] + b * y_m_[i] + c * z_m_[i] + plane.offset_m;
      count += std::abs(height_m) <= tolerance_m;
    }
    return count;
  }

  /// The plane through the points near a plane, with Tukey's weights.
  Plane refined(const Plane& plane, float tolerance_m) const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const float share = plane.height_m(at(i)) / tolerance_m;
      if (std::abs(share) >= 1) continue;
      const double weight = std::pow(1 - static_cast<double>(share * share), 2);
      const Eigen::Vector3d p = at(i).cast<double>();
      sum += weight;
      mean += weight * p;
      squares += weight * p * p.transpose();
    }
    mean /= sum;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / sum -
                                                              mean * mean.transpose());
    const Eigen::Vector3d normal = axes.eigenvectors().col(0);
    return {normal.cast<float>(), static_cast<float>(-normal.dot(mean))};
  }

 private:
  std::vector<float> x_m_, y_m_, z_m_;
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
  if (inliers.indices.empty()) return std::nullopt;
  const Plane plane{{coefficients.values[0], coefficients.values[1], coefficients.values[2]},
                    coefficients.values[3]};
  return if_floor(cloud, plane, inliers.indices.size(), parameters);
}

std::optional<Plane> fit_floor(const Cloud& cloud, const std::optional<Eigen::Vector3f>& up_camera,
                               const PreprocessParameters& parameters) {
  if (cloud.size() < 3) return std::nullopt;
  const auto tolerance_m = static_cast<float>(parameters.plane_tolerance_m);
  const SampledPoints points(cloud, cloud.size() / kSample + 1);
  std::minstd_rand random;  // the same for every frame
  const auto point = [&] { return points.at(random() % points.size()); };
  Plane best;
  int most_n = 0;
  for (int i = 0; i < parameters.plane_iterations_n; ++i) {
    const Eigen::Vector3f p = point();
    // A normal that is nearly known needs no two points more, of which few are the floor's.
    const bool is_stated = up_camera && i % 2 == 0;
    const Eigen::Vector3f a = point() - p;
    const Eigen::Vector3f b = point() - p;
    const Eigen::Vector3f normal = is_stated ? *up_camera : a.cross(b).normalized();
    const Plane plane{normal, -normal.dot(p)};
    if (!is_upright(plane, up_camera)) continue;
    const int count = points.count_within(plane, tolerance_m);
    if (count <= most_n) continue;
    most_n = count;
    best = plane;
  }
  if (most_n < 3) return std::nullopt;
  for (int i = 0; i < kPlaneRefinements; ++i) best = points.refined(best, 2 * tolerance_m);
  if (!is_upright(best, up_camera)) return std::nullopt;
  const auto inliers_n =
      std::count_if(cloud.points_m.begin(), cloud.points_m.end(),
                    [&](const auto& p) { return std::abs(best.height_m(p)) <= tolerance_m; });
  return if_floor(cloud, best, static_cast<std::size_t>(inliers_n), parameters);
}

Cloud above_plane(const Cloud& cloud, const Plane& plane, double max_height_m,
                  const PreprocessParameters& parameters) {
  return filtered(cloud, [&](const Eigen::Vector3f& p) {
    const float height_m = plane.height_m(p);
    return height_m > parameters.plane_tolerance_m && height_m <= max_height_m;
  });
}

Cloud over_floor(const Cloud& cloud, const Cloud& all, const Plane& floor, double part_diameter_m,
                 const PreprocessParameters& parameters) {
  const FloorGrid grid(floor, all);
  cv::Mat_<float> top_m(grid.size(), -1);
  cv::Mat_<uchar> is_floor(grid.size(), uchar{0});
  for (const auto& p : all.points_m) {
    const float height_m = floor.height_m(p);
    const cv::Point cell = grid.cell(p);
    top_m(cell) = std::max(top_m(cell), height_m);
    if (std::abs(height_m) <= parameters.plane_tolerance_m) is_floor(cell) = 1;
  }
  const cv::Mat is_low = is_floor | ((top_m >= 0) & (top_m <= part_diameter_m));
  cv::Mat_<int> labels;
  std::vector<int> floor_cells_n(static_cast<std::size_t>(cv::connectedComponents(is_low, labels)));
  std::vector<cv::Point> cells, hull;
  cv::findNonZero(is_floor, cells);
  for (const cv::Point& cell : cells) ++floor_cells_n[labels(cell)];
  const auto most = std::max_element(floor_cells_n.begin(), floor_cells_n.end());
  const auto largest = static_cast<int>(most - floor_cells_n.begin());
  std::erase_if(cells, [&](const cv::Point& cell) { return labels(cell) != largest; });
  cv::convexHull(cells, hull);
  return filtered(cloud, [&](const Eigen::Vector3f& p) {
    const double inside_cells = cv::pointPolygonTest(hull, cv::Point2f(grid.cell(p)), true);
    return inside_cells * FloorGrid::kCell_m >= parameters.wall_margin_m;
  });
}

}  // namespace graspd::perception
