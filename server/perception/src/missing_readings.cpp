#include "missing_readings.hpp"

#include <fmt/format.h>

namespace graspd::perception {
namespace {

/// Of the pixels that look at the bin's floor. Dark or shiny parts leave holes, but not so many.
constexpr double kLeastShare = 0.7;
constexpr int kEvery_px = 4;

}  // namespace

std::optional<std::string> missing_readings(const DepthFrame& frame, const PlanRequest& request) {
  if (!request.bin) return std::nullopt;
  const Eigen::Isometry3d T_bin_camera = request.bin->T_base_bin.inverse() * request.T_base_camera;
  const Eigen::Vector3d from_m = T_bin_camera.translation();
  const Eigen::Vector2d half_m = request.bin->inner_size_m.head<2>() / 2;
  const CameraIntrinsics& camera = frame.camera;
  int pixels_n = 0, readings_n = 0;
  for (int v = 0; v < camera.height_px; v += kEvery_px) {
    for (int u = 0; u < camera.width_px; u += kEvery_px) {
      // Its lens bends this by a pixel or two, which a share of the whole bin does not show.
      const Eigen::Vector3d ray((u - camera.cx_px) / camera.fx_px,
                                (v - camera.cy_px) / camera.fy_px, 1);
      const Eigen::Vector3d along = T_bin_camera.linear() * ray;
      if (along.z() >= 0) continue;
      const Eigen::Vector3d p_bin_m = from_m - along * (from_m.z() / along.z());
      if ((p_bin_m.head<2>().array().abs() > half_m.array()).any()) continue;
      ++pixels_n;
      readings_n += frame.at(u, v) != 0;
    }
  }
  if (readings_n >= kLeastShare * pixels_n) return std::nullopt;
  return fmt::format(
      "only {:.0f} % of the pixels that look into the bin have a reading: what lies elsewhere in "
      "it "
      "is not seen; check what is before the lens, and how dark or shiny the parts are",
      100.0 * readings_n / pixels_n);
}

}  // namespace graspd::perception
