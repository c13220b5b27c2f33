#include "graspd/agent/surroundings.hpp"

#include "graspd/types/camera_model.hpp"

namespace graspd::agent {
namespace {

constexpr double kNearBin_m = 0.1;

std::vector<Eigen::Vector3f> rays_of(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      rays.emplace_back(ray_through(camera, u, v).cast<float>());
    }
  }
  return rays;
}

/// A box in base that readings count in.
struct Region {
  Eigen::Isometry3f T_region_camera;
  Eigen::Vector3f from_m;
  Eigen::Vector3f to_m;
};

Region region_of(const PlanRequest& request) {
  Region region{request.T_base_camera.cast<float>(), Eigen::Vector3f::Constant(-HUGE_VALF),
                Eigen::Vector3f::Constant(HUGE_VALF)};
  if (request.bin) {
    const Eigen::Vector3d half_m(request.bin->inner_size_m.x() / 2,
                                 request.bin->inner_size_m.y() / 2, 0);
    const Eigen::Vector3d top_m = half_m + Eigen::Vector3d(0, 0, request.bin->inner_size_m.z());
    const Eigen::Vector3d near_m = Eigen::Vector3d::Constant(kNearBin_m);
    region.T_region_camera =
        (request.bin->T_base_bin.inverse() * request.T_base_camera).cast<float>();
    region.from_m = (-half_m - near_m).cast<float>();
    region.to_m = (top_m + near_m).cast<float>();
  } else if (request.crop_box) {
    region.T_region_camera =
        (request.crop_box->T_base_box.inverse() * request.T_base_camera).cast<float>();
    region.to_m = (request.crop_box->size_m / 2).cast<float>();
    region.from_m = -region.to_m;
  }
  return region;
}

}  // namespace

Surroundings Surveyor::survey(const DepthFrame& frame, const PlanRequest& request) {
  if (camera_ != frame.camera) {
    rays_ = rays_of(frame.camera);
    camera_ = frame.camera;
  }
  const Region region = region_of(request);
  const Eigen::Isometry3f T_base_camera = request.T_base_camera.cast<float>();
  Surroundings surroundings;
  surroundings.bin = request.bin;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.depth[i] == 0) continue;
    const auto z_m = static_cast<float>(frame.depth[i] * frame.depth_scale_m);
    const Eigen::Vector3f p_camera_m = rays_[i] * z_m;
    const Eigen::Vector3f p_region_m = region.T_region_camera * p_camera_m;
    const bool inside = (p_region_m.array() >= region.from_m.array()).all() &&
                        (p_region_m.array() <= region.to_m.array()).all();
    if (inside) surroundings.p_base_m.emplace_back(T_base_camera * p_camera_m);
  }
  return surroundings;
}

}  // namespace graspd::agent
