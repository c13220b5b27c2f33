#include "graspd/perception/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "graspd/types/camera_model.hpp"

namespace graspd::perception {
namespace {

/// The mask is drawn this many times finer than the image.
constexpr int kOversampling = 4;

}  // namespace

std::vector<float> outline_px(const CameraIntrinsics& camera, const parts::Mesh& mesh,
                              const Eigen::Isometry3d& T_camera_part) {
  std::vector<Eigen::Vector2d> pixels;
  for (const auto& vertex : mesh.vertices_m) {
    const Eigen::Vector3d p = T_camera_part * vertex.cast<double>();
    if (p.z() <= 0) return {};
    pixels.push_back(project(camera, p));
  }
  if (pixels.empty()) return {};
  Eigen::AlignedBox2d box;
  for (const auto& pixel : pixels) box.extend(pixel);
  box = box.intersection(Eigen::AlignedBox2d(
      Eigen::Vector2d(0, 0), Eigen::Vector2d(camera.width_px - 1, camera.height_px - 1)));
  if (box.isEmpty()) return {};
  const Eigen::Vector2d origin = box.min().array().floor() - 1;
  const Eigen::Vector2i size =
      ((box.max() - origin) * kOversampling).array().ceil().cast<int>() + 2 * kOversampling;

  cv::Mat mask = cv::Mat::zeros(size.y(), size.x(), CV_8UC1);
  for (const auto& triangle : mesh.triangles) {
    std::array<cv::Point, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d corner = (pixels[triangle[i]] - origin) * kOversampling;
      corners[i] = {static_cast<int>(std::lround(corner.x())),
                    static_cast<int>(std::lround(corner.y()))};
    }
    cv::fillConvexPoly(mask, corners.data(), 3, cv::Scalar(255));
  }
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (contours.empty()) return {};
  const auto& longest =
      *std::max_element(contours.begin(), contours.end(),
                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<cv::Point> simplified;
  cv::approxPolyDP(longest, simplified, 0.5 * kOversampling, /*closed=*/true);

  std::vector<float> outline;
  for (const cv::Point& point : simplified) {
    outline.push_back(static_cast<float>(origin.x() + point.x / double{kOversampling}));
    outline.push_back(static_cast<float>(origin.y() + point.y / double{kOversampling}));
  }
  return outline;
}

}  // namespace graspd::perception
