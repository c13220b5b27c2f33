#include "convert.hpp"
#include "wire_enums.hpp"

namespace graspd::codec {
namespace {

template <class T>
void write_numbers(const std::vector<T>& values, google::protobuf::RepeatedField<T>& out) {
  out.Add(values.begin(), values.end());
}

}  // namespace

void write(const Funnel& funnel, v1::Funnel& out) {
  out.set_pixels_n(funnel.pixels_n);
  out.set_readings_n(funnel.readings_n);
  out.set_after_passthrough_n(funnel.after_passthrough_n);
  out.set_after_voxel_grid_n(funnel.after_voxel_grid_n);
  out.set_after_plane_n(funnel.after_plane_n);
  out.set_segments_n(funnel.segments_n);
  out.set_hypotheses_n(funnel.hypotheses_n);
  out.set_registered_n(funnel.registered_n);
  out.set_rejected_score_n(funnel.rejected_score_n);
  out.set_grasps_n(funnel.grasps_n);
  const auto& [opening, cloud, parts, bin, held] = funnel.rejected_by_check_n;
  out.set_rejected_opening_n(opening);
  out.set_rejected_gripper_cloud_n(cloud);
  out.set_rejected_gripper_parts_n(parts);
  out.set_rejected_gripper_bin_n(bin);
  out.set_rejected_held_part_n(held);
}

void write(const GrsTerms& terms, v1::GrsTerms& out) {
  out.set_grs(terms.grs);
  out.set_p_self(terms.p_self);
  out.set_p_grasp(terms.p_grasp);
  out.set_p_system(terms.p_system);
  out.set_height_m(terms.height_m);
  out.set_inclination_rad(terms.inclination_rad);
  write_numbers(terms.neighbour_ids, *out.mutable_neighbour_ids());
  out.set_overlap_points_n(terms.overlap_points_n);
  write_numbers(terms.overlap_ids, *out.mutable_overlap_ids());
  out.set_load(terms.load);
  out.set_cover(terms.cover);
}

void write(const Object& object, v1::Object& out) {
  out.set_id(object.id);
  out.set_part_id(object.part_id);
  write(object.T_base_part, *out.mutable_t_base_part());
  out.set_score(object.score);
  out.set_visible_fraction(object.visible_fraction);
  out.set_inlier_fraction(object.inlier_fraction);
  out.set_refuted_fraction(object.refuted_fraction);
  out.set_rms_m(object.rms_m);
  write(object.p_base_segment_centroid_m, *out.mutable_p_base_segment_centroid_m());
  write_numbers(object.lies_on_ids, *out.mutable_lies_on_ids());
  write_numbers(object.supports_ids, *out.mutable_supports_ids());
  write_numbers(object.entangled_ids, *out.mutable_entangled_ids());
  write_numbers(object.double_pick_ids, *out.mutable_double_pick_ids());
  write(object.grs, *out.mutable_grs());
  write_numbers(object.outline_px, *out.mutable_outline_px());
}

void write(const CheckReport& report, v1::CheckReport& out) {
  out.set_check(to_wire(report.check));
  out.set_state(to_wire(report.state));
  out.set_reason(report.reason);
}

void write(const Grasp& grasp, v1::Grasp& out) {
  out.set_object_id(grasp.object_id);
  out.set_pick_point(grasp.pick_point);
  write(grasp.T_base_grasp, *out.mutable_t_base_grasp());
  out.set_opening_width_m(grasp.opening_width_m);
  out.set_standoff_m(grasp.standoff_m);
  out.set_retreat_m(grasp.retreat_m);
  out.set_room_m(grasp.room_m);
  out.set_score(grasp.score);
  write_list(grasp.checks, *out.mutable_checks());
}

void write(const StageTiming& timing, v1::StageTiming& out) {
  out.set_stage(timing.stage);
  out.set_duration_ns(timing.duration_ns);
}

void write(const ServerInfo& server, v1::ServerInfo& out) {
  out.set_build(server.build);
  out.set_catalogue_hash(server.catalogue_hash);
  out.set_config_hash(server.config_hash);
}

void write(const PlanAnswer& answer, v1::PlanAnswer& out) {
  out.set_outcome(to_wire(answer.outcome));
  out.set_reason(answer.reason);
  for (const std::string& warning : answer.warnings) out.add_warnings(warning);
  write(answer.funnel, *out.mutable_funnel());
  write_list(answer.objects, *out.mutable_objects());
  write_list(answer.grasps, *out.mutable_grasps());
  write_list(answer.rejected_grasps, *out.mutable_rejected_grasps());
  if (answer.fill_level) out.set_fill_level(*answer.fill_level);
  if (answer.bin_drift_m) out.set_bin_drift_m(*answer.bin_drift_m);
  write_list(answer.timings, *out.mutable_timings());
  write(answer.server, *out.mutable_server());
}

void write(const CodeCount& count, v1::CodeCount& out) {
  out.set_code(to_wire(count.code));
  out.set_answers_n(count.answers_n);
}

void write(const StageTotal& total, v1::StageTotal& out) {
  out.set_stage(total.stage);
  out.set_runs_n(total.runs_n);
  out.set_total_ns(total.total_ns);
}

void write(const HealthAnswer& answer, v1::HealthAnswer& out) {
  out.set_state(to_wire(answer.state));
  out.set_workers_n(answer.workers_n);
  out.set_workers_busy_n(answer.workers_busy_n);
  out.set_queued_n(answer.queued_n);
  out.set_answered_n(answer.answered_n);
  out.set_uptime_s(answer.uptime_s);
  for (const std::string& id : answer.part_ids) out.add_part_ids(id);
  write(answer.server, *out.mutable_server());
  write_list(answer.answers_by_code, *out.mutable_answers_by_code());
  write_list(answer.stages, *out.mutable_stages());
  out.set_workers_lost_n(answer.workers_lost_n);
  out.set_memory_bytes(answer.memory_bytes);
}

}  // namespace graspd::codec
