#include "graspd/perception/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "graspd/types/camera_model.hpp"

namespace graspd::perception {
namespace {

/// Surfaces seen flatter than this are too uncertain to speak for or against a pose.
constexpr double kMinFacingCosine = 0.2;

struct Seen {
  int u_px, v_px;
  double z_m;
};

/// The template points that the camera would see were the part alone: those that face it and lie
/// behind no other point of the part. Readings of a neighbouring pixel belong to the same surface,
/// since the template is about a pixel apart.
std::vector<Seen> visible_points(const CameraIntrinsics& camera, const parts::Part& part,
                                 const Eigen::Isometry3d& T_camera_part, double tolerance_m) {
  std::vector<Seen> facing;
  int u_low = camera.width_px, u_high = -1, v_low = camera.height_px, v_high = -1;
  for (const parts::SurfacePoint& point : part.surface) {
    const Eigen::Vector3d p = T_camera_part * point.position_m.cast<double>();
    if (p.z() <= 0) continue;
    const Eigen::Vector3d n = T_camera_part.linear() * point.normal.cast<double>();
    if (-n.dot(p) < kMinFacingCosine * p.norm()) continue;
    const Eigen::Vector2d pixel = project(camera, p);
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || u >= camera.width_px || v < 0 || v >= camera.height_px) continue;
    facing.push_back({u, v, p.z()});
    u_low = std::min(u_low, u);
    u_high = std::max(u_high, u);
    v_low = std::min(v_low, v);
    v_high = std::max(v_high, v);
  }
  // The nearest point at each pixel and its neighbours.
  const int width = u_high - u_low + 3;
  const int height = v_high - v_low + 3;
  if (facing.empty()) return facing;
  std::vector<double> nearest_m(static_cast<std::size_t>(width) * height,
                                std::numeric_limits<double>::max());
  const auto cell = [&](int u, int v) -> double& {
    return nearest_m[static_cast<std::size_t>(v - v_low + 1) * width + (u - u_low + 1)];
  };
  for (const Seen& point : facing) {
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        double& z_m = cell(point.u_px + du, point.v_px + dv);
        z_m = std::min(z_m, point.z_m);
      }
    }
  }
  std::erase_if(facing, [&](const Seen& point) {
    return point.z_m > cell(point.u_px, point.v_px) + 2 * tolerance_m;
  });
  return facing;
}

enum class Testimony { kSupports, kRefutes, kSilent };

struct Comparison {
  Testimony testimony = Testimony::kSilent;
  double error_m = 0;
};

Comparison compare(const DepthFrame& frame, const Seen& point, double tolerance_m) {
  bool behind = false;
  double best_error_m = tolerance_m;
  bool supported = false;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const int u = point.u_px + du;
      const int v = point.v_px + dv;
      if (u < 0 || u >= frame.camera.width_px || v < 0 || v >= frame.camera.height_px) continue;
      const std::uint16_t reading = frame.at(u, v);
      if (reading == 0) continue;
      const double error_m = reading * frame.depth_scale_m - point.z_m;
      if (du == 0 && dv == 0) {
        if (error_m < -tolerance_m) return {};  // hidden
        behind = error_m > tolerance_m;
      }
      if (std::abs(error_m) <= best_error_m) {
        best_error_m = std::abs(error_m);
        supported = true;
      }
    }
  }
  if (supported) return {Testimony::kSupports, best_error_m};
  return {behind ? Testimony::kRefutes : Testimony::kSilent, 0};
}

}  // namespace

Evidence evaluate_pose(const DepthFrame& frame, const parts::Part& part,
                       const Eigen::Isometry3d& T_camera_part, double tolerance_m) {
  const auto points = visible_points(frame.camera, part, T_camera_part, tolerance_m);
  if (points.empty()) return {};
  int supporting_n = 0;
  int refuting_n = 0;
  double sum2 = 0;
  for (const Seen& point : points) {
    const Comparison comparison = compare(frame, point, tolerance_m);
    supporting_n += comparison.testimony == Testimony::kSupports;
    refuting_n += comparison.testimony == Testimony::kRefutes;
    sum2 += comparison.error_m * comparison.error_m;
  }
  const auto count = static_cast<double>(points.size());
  Evidence evidence;
  evidence.visible_fraction = supporting_n / count;
  evidence.refuted_fraction = refuting_n / count;
  if (supporting_n > 0) {
    evidence.inlier_fraction = static_cast<double>(supporting_n) / (supporting_n + refuting_n);
    evidence.rms_m = std::sqrt(sum2 / supporting_n);
  }
  evidence.score = std::max(0.0, evidence.visible_fraction - evidence.refuted_fraction);
  return evidence;
}

}  // namespace graspd::perception
