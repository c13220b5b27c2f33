#include <algorithm>

#include "convert.hpp"
#include "wire_enums.hpp"

namespace graspd::codec {
namespace {

template <class T>
std::vector<T> read_numbers(const google::protobuf::RepeatedField<T>& in) {
  return {in.begin(), in.end()};
}

std::vector<float> read_outline(const google::protobuf::RepeatedField<float>& in, const Field& at) {
  if (in.size() % 2 != 0) at.refuse("{} numbers; u and v come in pairs", in.size());
  for (int i = 0; i < in.size(); ++i) at[i].number(in.Get(i));
  return read_numbers(in);
}

/// Whoever reads an answer looks objects up by id: every id must lead to one object.
class ObjectIds {
 public:
  ObjectIds(const std::vector<Object>& objects, const Field& at) {
    ids_.reserve(objects.size());
    for (const Object& object : objects) ids_.push_back(object.id);
    std::sort(ids_.begin(), ids_.end());
    const auto twice = std::adjacent_find(ids_.begin(), ids_.end());
    if (twice != ids_.end()) at.refuse("id {} stands twice; ids are unique in an answer", *twice);
  }

  void check(std::uint32_t id, const Field& at) const {
    if (!std::binary_search(ids_.begin(), ids_.end(), id)) {
      at.refuse("{} is the id of none of the answer's objects", id);
    }
  }
  void check(const std::vector<std::uint32_t>& ids, const Field& at) const {
    for (std::size_t i = 0; i < ids.size(); ++i) check(ids[i], at[static_cast<int>(i)]);
  }
  void check(const std::vector<Grasp>& grasps, const Field& at) const {
    for (std::size_t i = 0; i < grasps.size(); ++i) {
      const Field grasp = at[static_cast<int>(i)];
      check(grasps[i].object_id, grasp("object_id"));
    }
  }
  void check(const Object& object, const Field& at) const {
    check(object.lies_on_ids, at("lies_on_ids"));
    check(object.supports_ids, at("supports_ids"));
    check(object.entangled_ids, at("entangled_ids"));
    check(object.double_pick_ids, at("double_pick_ids"));
    const Field grs = at("grs");
    check(object.grs.neighbour_ids, grs("neighbour_ids"));
    check(object.grs.overlap_ids, grs("overlap_ids"));
  }

 private:
  std::vector<std::uint32_t> ids_;
};

void check_ids(const PlanAnswer& answer, const Field& at) {
  const Field objects = at("objects");
  const ObjectIds ids(answer.objects, objects);
  for (std::size_t i = 0; i < answer.objects.size(); ++i) {
    ids.check(answer.objects[i], objects[static_cast<int>(i)]);
  }
  ids.check(answer.grasps, at("grasps"));
  ids.check(answer.rejected_grasps, at("rejected_grasps"));
}

}  // namespace

Funnel read(const v1::Funnel& in, const Field&) {
  return {.pixels_n = in.pixels_n(),
          .readings_n = in.readings_n(),
          .after_passthrough_n = in.after_passthrough_n(),
          .after_voxel_grid_n = in.after_voxel_grid_n(),
          .after_plane_n = in.after_plane_n(),
          .segments_n = in.segments_n(),
          .hypotheses_n = in.hypotheses_n(),
          .registered_n = in.registered_n(),
          .rejected_score_n = in.rejected_score_n(),
          .grasps_n = in.grasps_n(),
          .rejected_by_check_n = {in.rejected_opening_n(), in.rejected_gripper_cloud_n(),
                                  in.rejected_gripper_parts_n(), in.rejected_gripper_bin_n(),
                                  in.rejected_held_part_n()}};
}

GrsTerms read(const v1::GrsTerms& in, const Field& at) {
  GrsTerms terms;
  terms.grs = at("grs").number(in.grs());
  terms.p_self = at("p_self").number(in.p_self());
  terms.p_grasp = at("p_grasp").number(in.p_grasp());
  terms.p_system = at("p_system").number(in.p_system());
  terms.height_m = at("height_m").number(in.height_m());
  terms.inclination_rad = at("inclination_rad").number(in.inclination_rad());
  terms.neighbour_ids = read_numbers(in.neighbour_ids());
  terms.overlap_points_n = in.overlap_points_n();
  terms.overlap_ids = read_numbers(in.overlap_ids());
  terms.load = at("load").number(in.load());
  terms.cover = at("cover").number(in.cover());
  return terms;
}

Object read(const v1::Object& in, const Field& at) {
  Object object;
  object.id = in.id();
  object.part_id = at("part_id").name(in.part_id());
  object.T_base_part = read(in.t_base_part(), at("T_base_part").required(in.has_t_base_part()));
  object.score = at("score").number(in.score());
  object.visible_fraction = at("visible_fraction").number(in.visible_fraction());
  object.inlier_fraction = at("inlier_fraction").number(in.inlier_fraction());
  object.refuted_fraction = at("refuted_fraction").number(in.refuted_fraction());
  object.rms_m = at("rms_m").number(in.rms_m());
  object.p_base_segment_centroid_m =
      read(in.p_base_segment_centroid_m(),
           at("p_base_segment_centroid_m").required(in.has_p_base_segment_centroid_m()));
  object.lies_on_ids = read_numbers(in.lies_on_ids());
  object.supports_ids = read_numbers(in.supports_ids());
  object.entangled_ids = read_numbers(in.entangled_ids());
  object.double_pick_ids = read_numbers(in.double_pick_ids());
  object.grs = read(in.grs(), at("grs").required(in.has_grs()));
  object.outline_px = read_outline(in.outline_px(), at("outline_px"));
  return object;
}

CheckReport read(const v1::CheckReport& in, const Field& at) {
  return {.check = from_wire<Check>(in.check(), at("check")),
          .state = from_wire<CheckState>(in.state(), at("state")),
          .reason = in.reason()};
}

Grasp read(const v1::Grasp& in, const Field& at) {
  Grasp grasp;
  grasp.object_id = in.object_id();
  grasp.pick_point = at("pick_point").name(in.pick_point());
  grasp.T_base_grasp = read(in.t_base_grasp(), at("T_base_grasp").required(in.has_t_base_grasp()));
  grasp.opening_width_m = at("opening_width_m").number(in.opening_width_m());
  grasp.standoff_m = at("standoff_m").number(in.standoff_m());
  grasp.retreat_m = at("retreat_m").number(in.retreat_m());
  grasp.room_m = at("room_m").number(in.room_m());
  grasp.score = at("score").number(in.score());
  grasp.checks = read_list(in.checks(), at("checks"));
  return grasp;
}

StageTiming read(const v1::StageTiming& in, const Field& at) {
  return {.stage = at("stage").name(in.stage()), .duration_ns = in.duration_ns()};
}

ServerInfo read(const v1::ServerInfo& in, const Field& at) {
  return {.build = at("build").name(in.build()),
          .catalogue_hash = at("catalogue_hash").name(in.catalogue_hash()),
          .config_hash = at("config_hash").name(in.config_hash())};
}

PlanAnswer read(const v1::PlanAnswer& in, const Field& at) {
  PlanAnswer answer;
  answer.outcome = from_wire<Outcome>(in.outcome(), at("outcome"));
  answer.reason = in.reason();
  if (answer.outcome != Outcome::kPlanned && answer.reason.empty()) {
    at("reason").refuse("empty; outcome {} needs a sentence", name_of(answer.outcome));
  }
  answer.warnings = {in.warnings().begin(), in.warnings().end()};
  answer.funnel = read(in.funnel(), at("funnel").required(in.has_funnel()));
  answer.objects = read_list(in.objects(), at("objects"));
  answer.grasps = read_list(in.grasps(), at("grasps"));
  answer.rejected_grasps = read_list(in.rejected_grasps(), at("rejected_grasps"));
  if (in.has_fill_level()) answer.fill_level = at("fill_level").number(in.fill_level());
  if (in.has_bin_drift_m()) answer.bin_drift_m = at("bin_drift_m").number(in.bin_drift_m());
  answer.timings = read_list(in.timings(), at("timings"));
  answer.server = read(in.server(), at("server").required(in.has_server()));
  check_ids(answer, at);
  return answer;
}

CodeCount read(const v1::CodeCount& in, const Field& at) {
  return {.code = from_wire<Code>(in.code(), at("code")), .answers_n = in.answers_n()};
}

StageTotal read(const v1::StageTotal& in, const Field& at) {
  return {.stage = at("stage").name(in.stage()), .runs_n = in.runs_n(), .total_ns = in.total_ns()};
}

HealthAnswer read(const v1::HealthAnswer& in, const Field& at) {
  HealthAnswer answer;
  answer.state = from_wire<ServerState>(in.state(), at("state"));
  answer.workers_n = in.workers_n();
  answer.workers_busy_n = in.workers_busy_n();
  answer.queued_n = in.queued_n();
  answer.answered_n = in.answered_n();
  answer.uptime_s = at("uptime_s").number(in.uptime_s());
  answer.part_ids = {in.part_ids().begin(), in.part_ids().end()};
  answer.server = read(in.server(), at("server").required(in.has_server()));
  answer.answers_by_code = read_list(in.answers_by_code(), at("answers_by_code"));
  answer.stages = read_list(in.stages(), at("stages"));
  answer.workers_lost_n = in.workers_lost_n();
  answer.memory_bytes = in.memory_bytes();
  return answer;
}

}  // namespace graspd::codec
