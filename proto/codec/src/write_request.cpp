#include "convert.hpp"
#include "wire_enums.hpp"

namespace graspd::codec {

void write(const Eigen::Vector3d& vector, v1::Vector3& out) {
  out.set_x(vector.x());
  out.set_y(vector.y());
  out.set_z(vector.z());
}

void write(const Eigen::Isometry3d& pose, v1::Pose& out) {
  write(Eigen::Vector3d(pose.translation()), *out.mutable_translation_m());
  // Not normalised: what is no rotation must not look like one to the reader.
  const Eigen::Quaterniond q(pose.linear());
  auto& rotation = *out.mutable_rotation();
  rotation.set_w(q.w());
  rotation.set_x(q.x());
  rotation.set_y(q.y());
  rotation.set_z(q.z());
}

void write(const CameraIntrinsics& camera, v1::CameraIntrinsics& out) {
  out.set_width_px(camera.width_px);
  out.set_height_px(camera.height_px);
  out.set_fx_px(camera.fx_px);
  out.set_fy_px(camera.fy_px);
  out.set_cx_px(camera.cx_px);
  out.set_cy_px(camera.cy_px);
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  auto& distortion = *out.mutable_distortion();
  distortion.set_k1(k1);
  distortion.set_k2(k2);
  distortion.set_p1(p1);
  distortion.set_p2(p2);
  distortion.set_k3(k3);
}

void write(const Bin& bin, v1::Bin& out) {
  write(bin.T_base_bin, *out.mutable_t_base_bin());
  write(bin.inner_size_m, *out.mutable_inner_size_m());
  out.set_wall_thickness_m(bin.wall_thickness_m);
}

void write(const CropBox& box, v1::CropBox& out) {
  write(box.T_base_box, *out.mutable_t_base_box());
  write(box.size_m, *out.mutable_size_m());
}

void write(const Gripper& gripper, v1::Gripper& out) {
  out.set_kind(to_wire(gripper.kind));
  out.set_min_opening_m(gripper.min_opening_m);
  out.set_max_opening_m(gripper.max_opening_m);
  out.set_clearance_m(gripper.clearance_m);
  out.set_standoff_m(gripper.standoff_m);
  out.set_retreat_m(gripper.retreat_m);
  write(gripper.jaw_size_m, *out.mutable_jaw_size_m());
  write(gripper.palm_size_m, *out.mutable_palm_size_m());
  out.set_cup_diameter_m(gripper.cup_diameter_m);
}

void write(const PlanOptions& options, v1::PlanOptions& out) {
  out.set_segmentation(to_wire(options.segmentation));
  out.set_registration(to_wire(options.registration));
  out.set_order(to_wire(options.order));
  out.set_p_system(to_wire(options.p_system));
  out.set_strategy(to_wire(options.strategy));
  write(options.strategy_vector_base_m, *out.mutable_strategy_vector_base_m());
  out.set_max_grasps_n(options.max_grasps_n);
  out.set_explain_rejected(options.explain_rejected);
  out.set_outlines(options.outlines);
  out.set_record(options.record);
}

void write(const LastObject& object, v1::LastObject& out) {
  out.set_id(object.id);
  out.set_part_id(object.part_id);
  write(object.T_base_part, *out.mutable_t_base_part());
  write(object.p_base_segment_centroid_m, *out.mutable_p_base_segment_centroid_m());
  out.set_score(object.score);
  out.set_visible_fraction(object.visible_fraction);
}

void write(const LastPlan& plan, v1::LastPlan& out) {
  write_list(plan.objects, *out.mutable_objects());
  if (plan.picked_object_id) out.set_picked_object_id(*plan.picked_object_id);
}

void write(const FrameDescription& frame, v1::FrameDescription& out) {
  write(frame.camera, *out.mutable_camera());
  out.set_depth_scale_m(frame.depth_scale_m);
  out.set_encoding(to_wire(frame.encoding));
  out.set_payload_bytes(frame.payload_bytes);
  out.set_payload_crc32(frame.payload_crc32);
}

void write(const RequestedPart& part, v1::RequestedPart& out) {
  out.set_id(part.id);
  out.set_priority(part.priority);
}

void write(const FailedSpot& spot, v1::FailedSpot& out) {
  write(spot.p_base_m, *out.mutable_p_base_m());
  out.set_radius_m(spot.radius_m);
  out.set_failures_n(spot.failures_n);
  out.set_reason(spot.reason);
}

void write(const PlanRequest& request, v1::PlanRequest& out) {
  write(request.T_base_camera, *out.mutable_t_base_camera());
  if (request.bin) write(*request.bin, *out.mutable_bin());
  if (request.crop_box) write(*request.crop_box, *out.mutable_crop_box());
  write_list(request.parts, *out.mutable_parts());
  write(request.gripper, *out.mutable_gripper());
  write(request.options, *out.mutable_options());
  if (request.last_plan) write(*request.last_plan, *out.mutable_last_plan());
  write_list(request.failed_spots, *out.mutable_failed_spots());
}

}  // namespace graspd::codec
