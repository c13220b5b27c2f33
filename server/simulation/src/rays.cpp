#include "rays.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::simulation {

std::vector<Eigen::Vector3d> pixel_rays(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(std::size_t(camera.width_px) * std::size_t(camera.height_px));
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) rays.push_back(ray_through(camera, u, v));
  }
  return rays;
}

CameraIntrinsics rectified_camera(const CameraIntrinsics& camera,
                                  const std::vector<Eigen::Vector3d>& rays, int rays_per_side_n) {
  CameraIntrinsics pinhole = camera;
  pinhole.distortion = {};
  double beyond_px = 0;
  for (const Eigen::Vector3d& ray : rays) {
    const Eigen::Vector2d uv = project(pinhole, ray);
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

}  // namespace graspd::simulation
