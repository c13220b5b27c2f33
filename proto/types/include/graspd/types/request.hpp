#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/types/frame.hpp"

/// What a plan request says beside the depth frame. Frames: `base` (robot base, z up), `camera`
/// (optical), `bin` (centre of the bin's floor, z up, x along its longer side), `part` (CAD),
/// `grasp` (midway between the finger tips, z the approach direction, x the closing direction).
/// `T_a_b` is the pose of b in a and maps b's coordinates to a's.
namespace graspd {

/// How the cloud is divided into parts: see `segmentation_method`.
enum class Segmentation {
  kServerDefault,
  kImprovedDbscan,
  kDbscan,
  kEuclidean,
  kRegionGrowing,
  kGridDbscan
};
/// How a part's pose is found: see `registration_method`, and `register_verified`.
enum class Registration { kServerDefault, kPcaIcp, kSacIaIcp, kNdtIcp, kVerified };
/// Whether the highest GRS is grasped first, as the paper's text has it, or the lowest, as its
/// equation.
enum class GraspOrder { kServerDefault, kDescending, kAscending };
/// What stands for P_system in the GRS: the paper's count of shared points, or the pile graph.
enum class PSystem { kServerDefault, kCount, kSupport };
/// What grasps are ranked by.
enum class Strategy { kServerDefault, kGrs, kHighest, kMostVisible, kNearest, kPreferredApproach };
enum class GripperKind { kParallelJaw, kSuction };

template <>
struct EnumNames<Segmentation> {
  static constexpr std::string_view what = "segmentation";
  static constexpr std::pair<Segmentation, std::string_view> values[] = {
      {Segmentation::kImprovedDbscan, "improved_dbscan"},
      {Segmentation::kDbscan, "dbscan"},
      {Segmentation::kEuclidean, "euclidean"},
      {Segmentation::kRegionGrowing, "region_growing"},
      {Segmentation::kGridDbscan, "grid_dbscan"}};
};
template <>
struct EnumNames<Registration> {
  static constexpr std::string_view what = "registration";
  static constexpr std::pair<Registration, std::string_view> values[] = {
      {Registration::kPcaIcp, "pca_icp"},
      {Registration::kSacIaIcp, "sac_ia_icp"},
      {Registration::kNdtIcp, "ndt_icp"},
      {Registration::kVerified, "verified"}};
};
template <>
struct EnumNames<GraspOrder> {
  static constexpr std::string_view what = "order";
  static constexpr std::pair<GraspOrder, std::string_view> values[] = {
      {GraspOrder::kDescending, "descending"}, {GraspOrder::kAscending, "ascending"}};
};
template <>
struct EnumNames<PSystem> {
  static constexpr std::string_view what = "p_system";
  static constexpr std::pair<PSystem, std::string_view> values[] = {{PSystem::kCount, "count"},
                                                                    {PSystem::kSupport, "support"}};
};
template <>
struct EnumNames<Strategy> {
  static constexpr std::string_view what = "strategy";
  static constexpr std::pair<Strategy, std::string_view> values[] = {
      {Strategy::kGrs, "grs"},
      {Strategy::kHighest, "highest"},
      {Strategy::kMostVisible, "most_visible"},
      {Strategy::kNearest, "nearest"},
      {Strategy::kPreferredApproach, "preferred_approach"}};
};
template <>
struct EnumNames<GripperKind> {
  static constexpr std::string_view what = "gripper kind";
  static constexpr std::pair<GripperKind, std::string_view> values[] = {
      {GripperKind::kParallelJaw, "parallel_jaw"}, {GripperKind::kSuction, "suction"}};
};

/// A box open at the top. Its walls stand outside of `inner_size_m`.
struct Bin {
  Eigen::Isometry3d T_base_bin = Eigen::Isometry3d::Identity();
  Eigen::Vector3d inner_size_m = Eigen::Vector3d::Zero();  ///< x, y, and z from floor to rim
  double wall_thickness_m = 0;
};

/// Where there is no bin: only points inside this box are looked at. Origin at its centre.
struct CropBox {
  Eigen::Isometry3d T_base_box = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};

/// A gripper as boxes, in the grasp frame.
struct Gripper {
  GripperKind kind = GripperKind::kParallelJaw;
  double min_opening_m = 0;     ///< between the jaws' inner faces
  double max_opening_m = 0.08;  ///< the stroke's upper end
  double clearance_m = 0.005;   ///< added to the part's width on each side before closing
  double standoff_m = 0.08;     ///< from pre-grasp to grasp, along the approach
  double retreat_m = 0.10;      ///< straight up after closing
  /// One jaw: x thickness along the closing direction, y width, z length from the palm to the tip.
  Eigen::Vector3d jaw_size_m{0.008, 0.016, 0.045};
  Eigen::Vector3d palm_size_m{0.10, 0.06, 0.06};  ///< box above the jaws, in the grasp frame's axes
  double cup_diameter_m = 0;                      ///< suction only
};

/// One kind of part that may be in the bin.
struct RequestedPart {
  std::string id;
  double priority = 0;  ///< higher first among equal grasps
};

/// What a caller may choose for one plan; by default the server does.
struct PlanOptions {
  Segmentation segmentation = Segmentation::kServerDefault;
  Registration registration = Registration::kServerDefault;
  GraspOrder order = GraspOrder::kServerDefault;
  PSystem p_system = PSystem::kServerDefault;
  Strategy strategy = Strategy::kServerDefault;
  /// For `nearest` a point in base, for `preferred_approach` a direction in base.
  Eigen::Vector3d strategy_vector_base_m = Eigen::Vector3d::Zero();
  std::uint32_t max_grasps_n = 0;  ///< 0: the server's default
  bool explain_rejected = false;   ///< answer the rejected grasps too, with the reason of each
  bool outlines = false;           ///< answer each object's visible outline in pixels
  bool record = false;             ///< the server's flight recorder keeps it, where there is one
};

/// What the last plan of this bin said of one object. Comes back so that the server stays
/// stateless.
struct LastObject {
  std::uint32_t id = 0;
  std::string part_id;
  Eigen::Isometry3d T_base_part = Eigen::Isometry3d::Identity();
  Eigen::Vector3d p_base_segment_centroid_m = Eigen::Vector3d::Zero();
  double score = 0;
  double visible_fraction = 0;
};

/// The plan before this one, for the displacement check.
struct LastPlan {
  std::vector<LastObject> objects;
  std::optional<std::uint32_t> picked_object_id;  ///< left out of the displacement check
};

/// A spot where a grasp has failed, or that the arm could not take: grasps within its radius are
/// ranked down.
struct FailedSpot {
  Eigen::Vector3d p_base_m = Eigen::Vector3d::Zero();
  double radius_m = 0.02;
  std::uint32_t failures_n = 1;
  std::string reason;  ///< for whoever reads the request: a short sentence
};

/// What is to be grasped, where, and with what. Either a bin or a crop box, or neither: then the
/// whole frame is looked at.
struct PlanRequest {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  std::optional<Bin> bin;
  std::optional<CropBox> crop_box;
  std::vector<RequestedPart> parts;
  Gripper gripper;
  PlanOptions options;
  std::optional<LastPlan> last_plan;
  std::vector<FailedSpot> failed_spots;
};

inline constexpr std::size_t kMaxPartsPerRequest = 32;
inline constexpr std::size_t kMaxLastObjects = 100;
inline constexpr std::size_t kMaxFailedSpots = 256;

/// Finite numbers, proper rotations, positive sizes, list lengths, a bin in front of the camera.
/// \returns INVALID_ARGUMENT naming the field, its value and what would be right.
Result<void> validate(const PlanRequest& request);

}  // namespace graspd
