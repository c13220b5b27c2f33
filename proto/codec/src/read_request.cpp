#include <cmath>

#include "convert.hpp"
#include "wire_enums.hpp"

namespace graspd::codec {

Eigen::Vector3d read(const v1::Vector3& in, const Field& at) {
  return {at("x").number(in.x()), at("y").number(in.y()), at("z").number(in.z())};
}

Eigen::Isometry3d read(const v1::Pose& in, const Field& at) {
  constexpr double kNormTolerance = 1e-3;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() =
      read(in.translation_m(), at("translation_m").required(in.has_translation_m()));
  const Field rotation = at("rotation");
  rotation.required(in.has_rotation());
  const Eigen::Quaterniond q(
      rotation("w").number(in.rotation().w()), rotation("x").number(in.rotation().x()),
      rotation("y").number(in.rotation().y()), rotation("z").number(in.rotation().z()));
  if (!(std::abs(q.norm() - 1) <= kNormTolerance)) {
    rotation.refuse("w {} x {} y {} z {} has norm {:.4g}; a unit quaternion has norm 1 ± {}", q.w(),
                    q.x(), q.y(), q.z(), q.norm(), kNormTolerance);
  }
  pose.linear() = q.normalized().toRotationMatrix();
  return pose;
}

CameraIntrinsics read(const v1::CameraIntrinsics& in, const Field& at) {
  CameraIntrinsics camera;
  camera.width_px = in.width_px();
  camera.height_px = in.height_px();
  camera.fx_px = at("fx_px").number(in.fx_px());
  camera.fy_px = at("fy_px").number(in.fy_px());
  camera.cx_px = at("cx_px").number(in.cx_px());
  camera.cy_px = at("cy_px").number(in.cy_px());
  const Field distortion = at("distortion");
  camera.distortion = {
      distortion("k1").number(in.distortion().k1()), distortion("k2").number(in.distortion().k2()),
      distortion("p1").number(in.distortion().p1()), distortion("p2").number(in.distortion().p2()),
      distortion("k3").number(in.distortion().k3())};
  return camera;
}

Bin read(const v1::Bin& in, const Field& at) {
  return {
      .T_base_bin = read(in.t_base_bin(), at("T_base_bin").required(in.has_t_base_bin())),
      .inner_size_m = read(in.inner_size_m(), at("inner_size_m").required(in.has_inner_size_m())),
      .wall_thickness_m = at("wall_thickness_m").number(in.wall_thickness_m())};
}

CropBox read(const v1::CropBox& in, const Field& at) {
  return {.T_base_box = read(in.t_base_box(), at("T_base_box").required(in.has_t_base_box())),
          .size_m = read(in.size_m(), at("size_m").required(in.has_size_m()))};
}

Gripper read(const v1::Gripper& in, const Field& at) {
  Gripper gripper;
  gripper.kind = from_wire<GripperKind>(in.kind(), at("kind"));
  gripper.min_opening_m = at("min_opening_m").number(in.min_opening_m());
  gripper.max_opening_m = at("max_opening_m").number(in.max_opening_m());
  gripper.clearance_m = at("clearance_m").number(in.clearance_m());
  gripper.standoff_m = at("standoff_m").number(in.standoff_m());
  gripper.retreat_m = at("retreat_m").number(in.retreat_m());
  gripper.jaw_size_m = read(in.jaw_size_m(), at("jaw_size_m").required(in.has_jaw_size_m()));
  gripper.palm_size_m = read(in.palm_size_m(), at("palm_size_m").required(in.has_palm_size_m()));
  gripper.cup_diameter_m = at("cup_diameter_m").number(in.cup_diameter_m());
  return gripper;
}

PlanOptions read(const v1::PlanOptions& in, const Field& at) {
  PlanOptions options;
  options.segmentation = from_wire<Segmentation>(in.segmentation(), at("segmentation"));
  options.registration = from_wire<Registration>(in.registration(), at("registration"));
  options.order = from_wire<GraspOrder>(in.order(), at("order"));
  options.p_system = from_wire<PSystem>(in.p_system(), at("p_system"));
  options.strategy = from_wire<Strategy>(in.strategy(), at("strategy"));
  const Field vector = at("strategy_vector_base_m");
  options.strategy_vector_base_m = read(in.strategy_vector_base_m(), vector);
  const bool vector_required =
      options.strategy == Strategy::kNearest || options.strategy == Strategy::kPreferredApproach;
  if (vector_required) vector.required(in.has_strategy_vector_base_m());
  options.max_grasps_n = in.max_grasps_n();
  options.explain_rejected = in.explain_rejected();
  options.outlines = in.outlines();
  options.record = in.record();
  return options;
}

RequestedPart read(const v1::RequestedPart& in, const Field& at) {
  return {.id = at("id").name(in.id()), .priority = at("priority").number(in.priority())};
}

LastObject read(const v1::LastObject& in, const Field& at) {
  LastObject object;
  object.id = in.id();
  object.part_id = at("part_id").name(in.part_id());
  object.T_base_part = read(in.t_base_part(), at("T_base_part").required(in.has_t_base_part()));
  object.p_base_segment_centroid_m =
      read(in.p_base_segment_centroid_m(),
           at("p_base_segment_centroid_m").required(in.has_p_base_segment_centroid_m()));
  object.score = at("score").number(in.score());
  object.visible_fraction = at("visible_fraction").number(in.visible_fraction());
  return object;
}

FailedSpot read(const v1::FailedSpot& in, const Field& at) {
  return {.p_base_m = read(in.p_base_m(), at("p_base_m").required(in.has_p_base_m())),
          .radius_m = at("radius_m").number(in.radius_m()),
          .failures_n = in.failures_n(),
          .reason = at("reason").name(in.reason())};
}

LastPlan read(const v1::LastPlan& in, const Field& at) {
  LastPlan plan;
  plan.objects = read_list(in.objects(), at("objects"), kMaxLastObjects);
  if (in.has_picked_object_id()) plan.picked_object_id = in.picked_object_id();
  return plan;
}

FrameDescription read(const v1::FrameDescription& in, const Field& at) {
  FrameDescription frame;
  frame.camera = read(in.camera(), at("camera").required(in.has_camera()));
  frame.depth_scale_m = at("depth_scale_m").number(in.depth_scale_m());
  frame.encoding = from_wire<DepthEncoding>(in.encoding(), at("encoding"));
  frame.payload_bytes = in.payload_bytes();
  frame.payload_crc32 = in.payload_crc32();
  at.accept(validate(frame));
  return frame;
}

PlanRequest read(const v1::PlanRequest& in, const Field& at) {
  PlanRequest request;
  request.T_base_camera =
      read(in.t_base_camera(), at("T_base_camera").required(in.has_t_base_camera()));
  if (in.has_bin()) request.bin = read(in.bin(), at("bin"));
  if (in.has_crop_box()) request.crop_box = read(in.crop_box(), at("crop_box"));
  request.parts = read_list(in.parts(), at("parts"), kMaxPartsPerRequest);
  request.gripper = read(in.gripper(), at("gripper").required(in.has_gripper()));
  request.options = read(in.options(), at("options"));
  if (in.has_last_plan()) request.last_plan = read(in.last_plan(), at("last_plan"));
  request.failed_spots = read_list(in.failed_spots(), at("failed_spots"), kMaxFailedSpots);
  at.accept(validate(request));
  return request;
}

}  // namespace graspd::codec
