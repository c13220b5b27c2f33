#include "rays.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::sim_cell {
namespace {

constexpr int kIterations = 12;

/// Inverse of OpenCV's distortion by fixed-point iteration, as cv::undistortPoints does it.
Eigen::Vector2d undistort(const Eigen::Vector2d& distorted, const std::array<double, 5>& k) {
  const auto& [k1, k2, p1, p2, k3] = k;
  Eigen::Vector2d ray = distorted;
  for (int i = 0; i < kIterations; ++i) {
    const double x = ray.x(), y = ray.y();
    const double r2 = ray.squaredNorm();
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const Eigen::Vector2d tangential(2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                                     p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
    ray = (distorted - tangential) / radial;
  }
  return ray;
}

}  // namespace

std::vector<Eigen::Vector2d> pixel_rays(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector2d> rays;
  rays.reserve(std::size_t(camera.width_px) * std::size_t(camera.height_px));
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      rays.push_back(
          undistort({(u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px},
                    camera.distortion));
    }
  }
  return rays;
}

CameraIntrinsics rectified_camera(const CameraIntrinsics& camera,
                                  const std::vector<Eigen::Vector2d>& rays, int rays_per_side_n) {
  double beyond_px = 0;
  for (const Eigen::Vector2d& ray : rays) {
    const Eigen::Vector2d uv = project(camera, ray);
    beyond_px = std::max(
        {beyond_px, -uv.x(), uv.x() - camera.width_px + 1, -uv.y(), uv.y() - camera.height_px + 1});
  }
  const int n = rays_per_side_n;
  const int border_px = int(std::ceil(beyond_px)) + 1;
  const auto side_px = [&](int px) { return n * (px + 2 * border_px); };
  // The camera's pixel 0 has its centre at the middle of n of the finer pixels.
  const auto centre_px = [&](double c_px) { return n * (c_px + border_px) + (n - 1) / 2.0; };
  return {side_px(camera.width_px),
          side_px(camera.height_px),
          n * camera.fx_px,
          n * camera.fy_px,
          centre_px(camera.cx_px),
          centre_px(camera.cy_px),
          {}};
}

}  // namespace graspd::sim_cell
