#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graspd/types/answer.hpp"

/// Two answers to one question compared: which grasps changed, by how much, and since which stage.
namespace graspd::recorded {

/// The pipeline's stages, as the answers' timings name them.
enum class Stage { kPreprocess, kDisplacement, kSegmentation, kRegistration, kGrasps, kOutlines };

/// A grasp of either answer, or the same one in both: of the same part, at most 20 mm and 30°
/// apart.
struct GraspChange {
  std::optional<std::size_t> old_rank;  ///< from 1; nothing: it is new
  std::optional<std::size_t> new_rank;  ///< nothing: it is gone
  std::string part_id;
  std::string pick_point;  ///< of the new one, where there is one
  double moved_m = 0;
  double turned_rad = 0;
  double opened_m = 0;  ///< by which the new opening is wider
  double old_score = 0;
  double new_score = 0;
};

/// What differs, and where it began.
struct AnswerDiff {
  /// The first stage whose results differ, as far as answers have them: counts of the funnel, the
  /// fill level, then objects, then grasps. Nothing: the stages agree.
  std::optional<Stage> since;
  std::string what;                 ///< of that stage: "after_plane_n 3412, now 3415"
  std::vector<GraspChange> grasps;  ///< by new rank, those that are gone last

  bool is_same() const { return what.empty(); }
};

/// Timings and what the servers say of themselves are left out of it.
AnswerDiff diff(const PlanAnswer& before, const PlanAnswer& now);

}  // namespace graspd::recorded

template <>
struct graspd::EnumNames<graspd::recorded::Stage> {
  using Stage = recorded::Stage;
  static constexpr std::string_view what = "stage";
  static constexpr std::pair<Stage, std::string_view> values[] = {
      {Stage::kPreprocess, "preprocess"},
      {Stage::kDisplacement, "displacement"},
      {Stage::kSegmentation, "segmentation"},
      {Stage::kRegistration, "registration"},
      {Stage::kGrasps, "grasps"},
      {Stage::kOutlines, "outlines"}};
};
