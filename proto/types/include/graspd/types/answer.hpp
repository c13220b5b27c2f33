#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/types/enum_names.hpp"

namespace graspd {

/// What became of a plan that was computed. "Nothing to grasp" is an answer with a reason.
enum class Outcome {
  kPlanned,
  kUnchanged,       ///< Nothing moved since the last plan: its remaining objects still stand.
  kBinEmpty,        ///< Nothing but floor and walls.
  kBinNotFound,     ///< The bin is not where the request says.
  kNoneRegistered,  ///< There are points, but none was recognised as a requested part.
  kAllInCollision,  ///< Parts were found, but every grasp fails a check.
  kNoneReachable,   ///< Set by the agent: no grasp within the arm's reach.
};

template <>
struct EnumNames<Outcome> {
  static constexpr std::string_view what = "outcome";
  static constexpr std::pair<Outcome, std::string_view> values[] = {
      {Outcome::kPlanned, "PLANNED"},
      {Outcome::kUnchanged, "UNCHANGED"},
      {Outcome::kBinEmpty, "BIN_EMPTY"},
      {Outcome::kBinNotFound, "BIN_NOT_FOUND"},
      {Outcome::kNoneRegistered, "NONE_REGISTERED"},
      {Outcome::kAllInCollision, "ALL_IN_COLLISION"},
      {Outcome::kNoneReachable, "NONE_REACHABLE"}};
};

/// What a grasp is checked for: the gripper's stroke; the gripper against what was seen, against
/// the other parts and against the bin; the part it lifts against the other parts and the walls.
enum class Check { kOpening, kGripperCloud, kGripperParts, kGripperBin, kHeldPart };
/// A check that is off, or lacks what it needs, is `kNotRun` and never passes silently.
enum class CheckState { kPassed, kFailed, kNotRun };

template <>
struct EnumNames<Check> {
  static constexpr std::string_view what = "check";
  static constexpr std::pair<Check, std::string_view> values[] = {
      {Check::kOpening, "opening"},
      {Check::kGripperCloud, "gripper_cloud"},
      {Check::kGripperParts, "gripper_parts"},
      {Check::kGripperBin, "gripper_bin"},
      {Check::kHeldPart, "held_part"}};
};
template <>
struct EnumNames<CheckState> {
  static constexpr std::string_view what = "check state";
  static constexpr std::pair<CheckState, std::string_view> values[] = {
      {CheckState::kPassed, "passed"},
      {CheckState::kFailed, "failed"},
      {CheckState::kNotRun, "not_run"}};
};

/// One check of one grasp.
struct CheckReport {
  Check check = Check::kOpening;
  CheckState state = CheckState::kNotRun;
  std::string reason;  ///< why it failed or was not run
};

/// How many were left after each stage: where an unexpected "no" came from.
struct Funnel {
  std::uint32_t pixels_n = 0;
  std::uint32_t readings_n = 0;           ///< pixels with a reading
  std::uint32_t after_passthrough_n = 0;  ///< points inside bin or crop box
  std::uint32_t after_voxel_grid_n = 0;
  std::uint32_t after_plane_n = 0;
  std::uint32_t segments_n = 0;
  std::uint32_t hypotheses_n = 0;  ///< poses tried, the roughest included
  std::uint32_t registered_n = 0;
  std::uint32_t rejected_score_n = 0;  ///< of the poses tried, those that are not answered
  std::uint32_t grasps_n = 0;
  /// Grasps each check rejected, in the order of Check.
  std::array<std::uint32_t, std::size(EnumNames<Check>::values)> rejected_by_check_n{};
};

/// GRS(i) = (α·P_self + β·P_grasp)·P_system, with what its terms were made of.
struct GrsTerms {
  double grs = 0;
  double p_self = 0;
  double p_grasp = 0;
  double p_system = 0;
  double height_m = 0;                       ///< barycentre above the bin's floor
  double inclination_rad = 0;                ///< principal axis from the horizontal plane
  std::vector<std::uint32_t> neighbour_ids;  ///< the K nearest objects of P_grasp, nearest first
  std::uint32_t overlap_points_n = 0;        ///< template points shared with other objects
  std::vector<std::uint32_t> overlap_ids;    ///< the objects they are shared with
  double load = 0;   ///< weight that rests on it, directly or through others, in parts
  double cover = 0;  ///< how much of other parts lies over it, each as a share of that part
};

/// A part that was recognised.
struct Object {
  std::uint32_t id = 0;
  std::string part_id;
  Eigen::Isometry3d T_base_part = Eigen::Isometry3d::Identity();
  double score = 0;             ///< in [0, 1]; of the default registration the pose's probability
  double visible_fraction = 0;  ///< of the model's surface that this view could show
  double inlier_fraction = 0;   ///< of the visible model points: a reading within tolerance
  double refuted_fraction = 0;  ///< of the visible model points: the camera saw through them
  double rms_m = 0;             ///< of the inliers' distances
  Eigen::Vector3d p_base_segment_centroid_m = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> lies_on_ids;
  std::vector<std::uint32_t> supports_ids;
  std::vector<std::uint32_t> entangled_ids;    ///< neither can be lifted without the other
  std::vector<std::uint32_t> double_pick_ids;  ///< lie over it: a lift may take them along
  GrsTerms grs;
  std::vector<float> outline_px;  ///< u, v, u, v, … closed; only where asked for
};

/// How the gripper takes one object. From `standoff_m` before the pose it goes straight along the
/// grasp frame's z, closes, and lifts by `retreat_m` along base z.
struct Grasp {
  std::uint32_t object_id = 0;
  std::string pick_point;  ///< "principal_axis", or the taught point's name
  Eigen::Isometry3d T_base_grasp = Eigen::Isometry3d::Identity();
  double opening_width_m = 0;
  double standoff_m = 0;
  double retreat_m = 0;
  double room_m = 0;  ///< by which the gripper could be wider and still collide with nothing
  double score = 0;   ///< by the strategy: GRS, height, visible fraction, −distance, cosine
  std::vector<CheckReport> checks;
};

/// One stage of the pipeline, wall time.
struct StageTiming {
  std::string stage;
  std::int64_t duration_ns = 0;
};

/// With these three and the request, an answer can be computed again bit by bit.
struct ServerInfo {
  std::string build;
  std::string catalogue_hash;
  std::string config_hash;
};

/// What a server says of one frame. Ids are the answer's own: `objects` have them, all else refers
/// to them.
struct PlanAnswer {
  Outcome outcome = Outcome::kPlanned;
  std::string reason;  ///< one sentence, for every outcome but PLANNED
  std::vector<std::string> warnings;
  Funnel funnel;
  std::vector<Object> objects;
  std::vector<Grasp> grasps;  ///< best first
  std::vector<Grasp> rejected_grasps;
  std::optional<double> fill_level;  ///< of the bin's volume, where a bin was given
  /// Of the corner of the bin's rim that is off most from where the request says, where the walls
  /// were seen.
  std::optional<double> bin_drift_m;
  std::vector<StageTiming> timings;
  ServerInfo server;
};

}  // namespace graspd
