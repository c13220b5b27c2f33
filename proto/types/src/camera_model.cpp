#include "graspd/types/camera_model.hpp"

namespace graspd {
namespace {

struct Distortion {
  double radial;
  Eigen::Vector2d tangential;
};

Distortion distortion_at(const Eigen::Vector2d& p, const std::array<double, 5>& k) {
  const auto& [k1, k2, p1, p2, k3] = k;
  const double r2 = p.squaredNorm();
  const double xy = p.x() * p.y();
  return {
      1 + r2 * (k1 + r2 * (k2 + r2 * k3)),
      {2 * p1 * xy + p2 * (r2 + 2 * p.x() * p.x()), p1 * (r2 + 2 * p.y() * p.y()) + 2 * p2 * xy}};
}

}  // namespace

Eigen::Vector2d project(const CameraIntrinsics& camera, const Eigen::Vector3d& p_camera_m) {
  const Eigen::Vector2d p = p_camera_m.head<2>() / p_camera_m.z();
  const auto [radial, tangential] = distortion_at(p, camera.distortion);
  const Eigen::Vector2d distorted = p * radial + tangential;
  return {camera.fx_px * distorted.x() + camera.cx_px, camera.fy_px * distorted.y() + camera.cy_px};
}

Eigen::Vector3d ray_through(const CameraIntrinsics& camera, double u_px, double v_px) {
  const Eigen::Vector2d distorted((u_px - camera.cx_px) / camera.fx_px,
                                  (v_px - camera.cy_px) / camera.fy_px);
  Eigen::Vector2d p = distorted;
  if (camera.distortion != std::array<double, 5>{}) {
    // Fixed-point iteration, which converges for the mild distortion of depth cameras.
    constexpr int kIterations = 12;
    for (int i = 0; i < kIterations; ++i) {
      const auto [radial, tangential] = distortion_at(p, camera.distortion);
      p = (distorted - tangential) / radial;
    }
  }
  return {p.x(), p.y(), 1};
}

}  // namespace graspd
