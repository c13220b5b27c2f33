#include "graspd/recorded/answer_diff.hpp"

#include <fmt/format.h>

#include "grasp_changes.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::recorded {
namespace {

template <class T>
std::string text_of(const T& value) {
  if constexpr (std::is_enum_v<T>)
    return std::string(name_of(value));
  else
    return fmt::format("{}", value);
}

/// Goes through the stages in their order; the first difference is kept.
class Comparison {
 public:
  void enter(Stage stage) { stage_ = stage; }

  template <class T>
  void compare(std::string_view name, const T& before, const T& now) {
    if (before == now) return;
    note("{} {}, now {}", name, text_of(before), text_of(now));
  }
  template <class... Args>
  void note(fmt::format_string<Args...> format, Args&&... args) {
    if (!what.empty()) return;
    since = stage_;
    what = fmt::format(format, std::forward<Args>(args)...);
  }

  std::optional<Stage> since;
  std::string what;

 private:
  Stage stage_ = Stage::kPreprocess;
};

std::string text_or_none(const std::optional<double>& value) {
  return value ? text_of(*value) : "none";
}

void compare_preprocess(const PlanAnswer& before, const PlanAnswer& now, Comparison& to) {
  to.enter(Stage::kPreprocess);
  const Funnel& a = before.funnel;
  const Funnel& b = now.funnel;
  to.compare("pixels_n", a.pixels_n, b.pixels_n);
  to.compare("readings_n", a.readings_n, b.readings_n);
  to.compare("after_passthrough_n", a.after_passthrough_n, b.after_passthrough_n);
  to.compare("after_voxel_grid_n", a.after_voxel_grid_n, b.after_voxel_grid_n);
  to.compare("after_plane_n", a.after_plane_n, b.after_plane_n);
  to.compare("fill_level", text_or_none(before.fill_level), text_or_none(now.fill_level));
  to.compare("bin_drift_m", text_or_none(before.bin_drift_m), text_or_none(now.bin_drift_m));
  const auto has_bin = [](const PlanAnswer& answer) {
    return answer.outcome != Outcome::kBinNotFound;
  };
  if (has_bin(before) != has_bin(now)) to.compare("outcome", before.outcome, now.outcome);
}

bool same_pose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return a.matrix() == b.matrix();
}

void compare_registered(const Object& a, const Object& b, Comparison& to) {
  const std::string name = fmt::format("object {} ({})", b.id, b.part_id);
  to.compare("id of an object", a.id, b.id);
  to.compare(name + " part", a.part_id, b.part_id);
  if (!same_pose(a.T_base_part, b.T_base_part)) {
    to.note("{} moved by {:.3g} mm", name,
            (a.T_base_part.translation() - b.T_base_part.translation()).norm() * 1e3);
  }
  to.compare(name + " score", a.score, b.score);
  to.compare(name + " visible_fraction", a.visible_fraction, b.visible_fraction);
  to.compare(name + " inlier_fraction", a.inlier_fraction, b.inlier_fraction);
  to.compare(name + " refuted_fraction", a.refuted_fraction, b.refuted_fraction);
  to.compare(name + " rms_m", a.rms_m, b.rms_m);
  if (a.p_base_segment_centroid_m != b.p_base_segment_centroid_m) {
    to.note("{}: centroid of its segment", name);
  }
}

void compare_registration(const PlanAnswer& before, const PlanAnswer& now, Comparison& to) {
  to.enter(Stage::kRegistration);
  const Funnel& a = before.funnel;
  const Funnel& b = now.funnel;
  to.compare("hypotheses_n", a.hypotheses_n, b.hypotheses_n);
  to.compare("rejected_score_n", a.rejected_score_n, b.rejected_score_n);
  to.compare("objects", before.objects.size(), now.objects.size());
  if (before.objects.size() != now.objects.size()) return;
  for (std::size_t i = 0; i < now.objects.size(); ++i) {
    compare_registered(before.objects[i], now.objects[i], to);
  }
}

void compare_grasps(const PlanAnswer& before, const PlanAnswer& now,
                    const std::vector<GraspChange>& changes, Comparison& to) {
  to.enter(Stage::kGrasps);
  for (std::size_t i = 0; i < std::min(before.objects.size(), now.objects.size()); ++i) {
    const Object& a = before.objects[i];
    const Object& b = now.objects[i];
    to.compare(fmt::format("object {} ({}) GRS", b.id, b.part_id), a.grs.grs, b.grs.grs);
    if (a.lies_on_ids != b.lies_on_ids || a.supports_ids != b.supports_ids ||
        a.entangled_ids != b.entangled_ids || a.double_pick_ids != b.double_pick_ids) {
      to.note("object {} ({}): its place in the pile graph", b.id, b.part_id);
    }
  }
  for (std::size_t i = 0; i < now.funnel.rejected_by_check_n.size(); ++i) {
    to.compare(fmt::format("rejected by {}", EnumNames<Check>::values[i].second),
               before.funnel.rejected_by_check_n[i], now.funnel.rejected_by_check_n[i]);
  }
  to.compare("grasps", before.grasps.size(), now.grasps.size());
  if (!changes.empty()) to.note("the grasps themselves");
  to.compare("rejected grasps", before.rejected_grasps.size(), now.rejected_grasps.size());
}

void compare_outlines(const PlanAnswer& before, const PlanAnswer& now, Comparison& to) {
  to.enter(Stage::kOutlines);
  for (std::size_t i = 0; i < std::min(before.objects.size(), now.objects.size()); ++i) {
    if (before.objects[i].outline_px == now.objects[i].outline_px) continue;
    to.note("outline of object {}", now.objects[i].id);
  }
}

/// All of an answer but its timings and its server.
std::string content_of(PlanAnswer answer) {
  answer.timings.clear();
  answer.server = {};
  return codec::encode_answer({.message = "", .body = std::move(answer)});
}

}  // namespace

AnswerDiff diff(const PlanAnswer& before, const PlanAnswer& now) {
  AnswerDiff result;
  if (content_of(before) == content_of(now)) return result;
  result.grasps = grasp_changes(before, now);
  Comparison comparison;
  compare_preprocess(before, now, comparison);
  const auto stands = [](const PlanAnswer& answer) {
    return answer.outcome == Outcome::kUnchanged;
  };
  comparison.enter(Stage::kDisplacement);
  if (stands(before) != stands(now)) comparison.compare("outcome", before.outcome, now.outcome);
  comparison.enter(Stage::kSegmentation);
  comparison.compare("segments_n", before.funnel.segments_n, now.funnel.segments_n);
  compare_registration(before, now, comparison);
  compare_grasps(before, now, result.grasps, comparison);
  compare_outlines(before, now, comparison);
  result.since = comparison.since;
  result.what = comparison.what.empty() ? "outcome, reason, warnings or details of checks"
                                        : std::move(comparison.what);
  return result;
}

}  // namespace graspd::recorded
