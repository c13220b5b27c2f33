#include <algorithm>
#include <cmath>

#include "graspd/types/request.hpp"

namespace graspd {
namespace {

constexpr double kMaxDistance_m = 100;

bool finite(const Eigen::Isometry3d& T) { return T.matrix().allFinite(); }

Result<void> validate_pose(const Eigen::Isometry3d& T, std::string_view field) {
  if (!finite(T)) return invalid("{}: the pose has a number that is not finite", field);
  const Eigen::Matrix3d R = T.linear();
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > 1e-4 || R.determinant() < 0) {
    return invalid("{}: not a rotation (R·Rᵀ is off by {:.2g}, determinant {:.3f})", field, error,
                   R.determinant());
  }
  if (T.translation().cwiseAbs().maxCoeff() > kMaxDistance_m) {
    return invalid("{}: {:.0f} m from the origin; poses are in metres, not millimetres", field,
                   T.translation().norm());
  }
  return {};
}

Result<void> validate_size(const Eigen::Vector3d& size_m, std::string_view field) {
  if (!size_m.allFinite() || size_m.minCoeff() <= 0 || size_m.maxCoeff() > kMaxDistance_m) {
    return invalid("{}: {} × {} × {} m; every side must be above 0 and at most {} m", field,
                   size_m.x(), size_m.y(), size_m.z(), kMaxDistance_m);
  }
  return {};
}

Result<void> validate_range(double value, double low, double high, std::string_view field) {
  if (!(value >= low && value <= high)) {
    return invalid("{}: {} is outside {} … {}", field, value, low, high);
  }
  return {};
}

Result<void> validate_gripper(const Gripper& gripper) {
  if (auto ok = validate_size(gripper.jaw_size_m, "gripper.jaw_size_m"); !ok) return ok;
  if (auto ok = validate_size(gripper.palm_size_m, "gripper.palm_size_m"); !ok) return ok;
  const std::pair<double, std::string_view> lengths[] = {
      {gripper.min_opening_m, "gripper.min_opening_m"},
      {gripper.max_opening_m, "gripper.max_opening_m"},
      {gripper.clearance_m, "gripper.clearance_m"},
      {gripper.standoff_m, "gripper.standoff_m"},
      {gripper.retreat_m, "gripper.retreat_m"},
      {gripper.cup_diameter_m, "gripper.cup_diameter_m"}};
  for (const auto& [length_m, field] : lengths) {
    if (auto ok = validate_range(length_m, 0, 2, field); !ok) return ok;
  }
  if (gripper.kind == GripperKind::kParallelJaw && gripper.max_opening_m <= gripper.min_opening_m) {
    return invalid("gripper: max_opening_m {} is not above min_opening_m {}", gripper.max_opening_m,
                   gripper.min_opening_m);
  }
  if (gripper.kind == GripperKind::kSuction && gripper.cup_diameter_m <= 0) {
    return invalid("gripper.cup_diameter_m: a suction gripper needs a cup wider than 0");
  }
  return {};
}

Result<void> validate_workspace(const PlanRequest& request) {
  const Eigen::Isometry3d T_camera_base = request.T_base_camera.inverse();
  if (request.bin && request.crop_box) {
    return invalid("bin and crop_box are both given: say one of them");
  }
  if (request.bin) {
    const Bin& bin = *request.bin;
    if (auto ok = validate_pose(bin.T_base_bin, "bin.T_base_bin"); !ok) return ok;
    if (auto ok = validate_size(bin.inner_size_m, "bin.inner_size_m"); !ok) return ok;
    if (auto ok = validate_range(bin.wall_thickness_m, 0, 1, "bin.wall_thickness_m"); !ok)
      return ok;
    const double z_m = (T_camera_base * bin.T_base_bin).translation().z();
    if (z_m <= 0) {
      return invalid(
          "bin.T_base_bin: the bin's floor is {:.3f} m behind the camera; check T_base_camera "
          "(z of the optical frame points from the camera into the scene) and T_base_bin",
          -z_m);
    }
  }
  if (request.crop_box) {
    if (auto ok = validate_pose(request.crop_box->T_base_box, "crop_box.T_base_box"); !ok)
      return ok;
    if (auto ok = validate_size(request.crop_box->size_m, "crop_box.size_m"); !ok) return ok;
    const double z_m = (T_camera_base * request.crop_box->T_base_box).translation().z();
    if (z_m <= 0) {
      return invalid("crop_box.T_base_box: the box's centre is {:.3f} m behind the camera", -z_m);
    }
  }
  return {};
}

Result<void> validate_memory(const PlanRequest& request) {
  if (request.last_plan) {
    const auto& objects = request.last_plan->objects;
    if (objects.size() > kMaxLastObjects) {
      return invalid("last_plan.objects: {} objects; at most {} are taken", objects.size(),
                     kMaxLastObjects);
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const std::string field = fmt::format("last_plan.objects[{}]", i);
      if (auto ok = validate_pose(objects[i].T_base_part, field + ".T_base_part"); !ok) return ok;
      if (!objects[i].p_base_segment_centroid_m.allFinite() || !std::isfinite(objects[i].score) ||
          !std::isfinite(objects[i].visible_fraction)) {
        return invalid("{}: a number is not finite", field);
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (objects[j].id == objects[i].id) {
          return invalid("{}.id: {} stands twice; ids are unique in a plan", field, objects[i].id);
        }
      }
    }
  }
  if (request.failed_spots.size() > kMaxFailedSpots) {
    return invalid("failed_spots: {} spots; at most {} are taken", request.failed_spots.size(),
                   kMaxFailedSpots);
  }
  for (std::size_t i = 0; i < request.failed_spots.size(); ++i) {
    const FailedSpot& spot = request.failed_spots[i];
    if (!spot.p_base_m.allFinite() || !(spot.radius_m > 0 && spot.radius_m <= 1)) {
      return invalid("failed_spots[{}]: needs a finite point and a radius above 0, at most 1 m", i);
    }
  }
  return {};
}

}  // namespace

Result<void> validate(const CameraIntrinsics& camera) {
  const auto side_ok = [](int side_px) { return side_px >= 8 && side_px <= kMaxImageSide_px; };
  if (!side_ok(camera.width_px) || !side_ok(camera.height_px)) {
    return invalid("camera: an image of {} × {} pixels; each side must be 8 … {}", camera.width_px,
                   camera.height_px, kMaxImageSide_px);
  }
  const std::pair<double, std::string_view> focal_lengths[] = {{camera.fx_px, "camera.fx_px"},
                                                               {camera.fy_px, "camera.fy_px"}};
  for (const auto& [focal_px, field] : focal_lengths) {
    if (!(std::isfinite(focal_px) && focal_px >= 1 && focal_px <= 1e5)) {
      return invalid("{}: {} is no focal length; it is in pixels, 1 … 100000", field, focal_px);
    }
  }
  const auto centre_ok = [](double c_px, int side_px) {
    return c_px >= -side_px && c_px <= 2.0 * side_px;
  };
  if (!centre_ok(camera.cx_px, camera.width_px) || !centre_ok(camera.cy_px, camera.height_px)) {
    return invalid("camera: principal point ({}, {}) is far outside the {} × {} image",
                   camera.cx_px, camera.cy_px, camera.width_px, camera.height_px);
  }
  for (const double k : camera.distortion) {
    if (!(std::isfinite(k) && std::abs(k) <= 100)) {
      return invalid("camera.distortion: {} is no coefficient; the order is k1, k2, p1, p2, k3", k);
    }
  }
  return {};
}

Result<void> validate(const DepthFrame& frame) {
  if (auto ok = validate(frame.camera); !ok) return ok;
  const auto pixels = static_cast<std::size_t>(frame.camera.width_px) *
                      static_cast<std::size_t>(frame.camera.height_px);
  if (frame.depth.size() != pixels) {
    return invalid("frame: {} depth values for an image of {} × {} = {} pixels", frame.depth.size(),
                   frame.camera.width_px, frame.camera.height_px, pixels);
  }
  if (!(std::isfinite(frame.depth_scale_m) && frame.depth_scale_m >= 1e-6 &&
        frame.depth_scale_m <= 0.1)) {
    return invalid("frame.depth_scale_m: {} m per unit; 0.001 says that units are millimetres",
                   frame.depth_scale_m);
  }
  if (std::all_of(frame.depth.begin(), frame.depth.end(), [](auto z) { return z == 0; })) {
    return invalid(
        "frame: all {} pixels are 0, which means no reading; check the camera and its cover",
        pixels);
  }
  return {};
}

Result<void> validate(const PlanRequest& request) {
  if (auto ok = validate_pose(request.T_base_camera, "T_base_camera"); !ok) return ok;
  if (auto ok = validate_workspace(request); !ok) return ok;
  if (request.parts.empty()) return invalid("parts: none requested; name at least one part");
  if (request.parts.size() > kMaxPartsPerRequest) {
    return invalid("parts: {} requested; at most {} are taken", request.parts.size(),
                   kMaxPartsPerRequest);
  }
  for (std::size_t i = 0; i < request.parts.size(); ++i) {
    if (request.parts[i].id.empty()) return invalid("parts[{}].id: empty", i);
    if (!std::isfinite(request.parts[i].priority)) {
      return invalid("parts[{}].priority: not a finite number", i);
    }
  }
  if (auto ok = validate_gripper(request.gripper); !ok) return ok;
  if (!request.options.strategy_vector_base_m.allFinite()) {
    return invalid("options.strategy_vector_base_m: not finite");
  }
  if (request.options.strategy == Strategy::kPreferredApproach &&
      request.options.strategy_vector_base_m.norm() < 1e-6) {
    return invalid("options.strategy_vector_base_m: preferred_approach needs a direction; it is 0");
  }
  return validate_memory(request);
}

}  // namespace graspd
