#pragma once

#include <string>

#include "graspd/types/request.hpp"

/// Every number the pipeline can be tuned by. The defaults are these; deploy/server.yaml documents
/// how to change them.
namespace graspd::perception {

/// More than any wall bows an image.
inline constexpr double kMaxWallBow_m = 0.02;

/// Lengths that follow the part's size are given as shares of its diameter.
struct PreprocessParameters {
  double min_depth_m = 0.3;
  double max_depth_m = 4.5;
  double voxel_m = 0.002;
  double wall_margin_m = 0.005;      ///< points nearer to a bin's wall are the wall's
  double heap_m = 0.06;              ///< parts may be heaped so far above a bin's rim
  double plane_tolerance_m = 0.005;  ///< RANSAC inlier distance; thinner plates are the floor's
  int plane_iterations_n = 200;
  double plane_min_share = 0.1;          ///< a smaller plane is a part's face, not the floor
  double max_behind_plane_share = 0.02;  ///< nothing lies below a floor
  int normal_neighbours_n = 12;
  double wall_bow_m = 0.006;    ///< by which the sensor sees all bend up towards the bin's walls
  bool find_wall_bow = true;    ///< from the parts, beginning with `wall_bow_m`
  double wall_reach_m = 0.075;  ///< of that bend: it falls with the square of what is left
  double bin_drift_warning_m = 0.006;  ///< a bin whose rim is off by more is warned of
  double max_bin_drift_m = 0.03;       ///< and by more than this it is not found
};

struct SegmentationParameters {
  Segmentation method = Segmentation::kGridDbscan;
  /// grid_dbscan's Eps in pixels at the points' mean depth: one Eps for the whole frame, 5.5 mm at
  /// 0.75 m. Of a flat surface that faces the camera it reaches 21 points, and MinPts is what a
  /// straight edge of one leaves: most parts of piles and of real tables came out whole so.
  double grid_eps_px = 2.7;
  int grid_min_points_n = 12;
  double eps_m = 0.004;
  int min_points_n = 6;  ///< MinPts: neighbours of a core point, itself included
  int octree_depth_n = 8;
  double smoothness_rad = 0.2;  ///< θ_th of Algorithm 1
  double curvature = 0.05;      ///< c_th of Algorithm 1
  double euclidean_tolerance_m = 0.0028;
  int region_neighbours_n = 30;
  double region_smoothness_rad = 0.2;
  double region_curvature = 0.15;
  double min_segment_share = 0.05;  ///< of the points the whole part would show
};

struct RegistrationParameters {
  Registration method = Registration::kVerified;
  int icp_iterations_n = 50;
  double icp_max_distance_m = 0.01;
  double inlier_tolerance_m = 0.006;
  double min_score = 0.25;
  double max_below_floor_m = 0.012;  ///< noise and multipath, but no part lies in the floor
  double feature_radius_m = 0.012;
  int sac_iterations_n = 400;
  double ndt_resolution_m = 0.02;
  double seed_spacing_m = 0.01;       ///< between the readings that hypotheses start from
  double normal_tolerance_rad = 0.5;  ///< of a reading's normal to a template's
  int templates_per_seed_n = 16;      ///< of each part, compared with the image at more points
  int hypotheses_per_seed_n = 3;      ///< of these, placed by ICP
  double coarse_tolerance_m = 0.01;   ///< before a hypothesis has been refined
  double min_coarse_score = 0.2;
  int coarse_per_place_n = 8;  ///< hypotheses with nearly the same barycentre
  int fine_per_place_n = 4;
  double refuted_weight = 1.5;       ///< of a refuting point over a supporting one
  double max_leftover_share = 0.28;  ///< of the outline: the same surface goes on beyond it
  double min_visible_share = 0.4;    ///< of the view's points: a reading within tolerance
  double min_unhidden_share = 0.5;   ///< likewise, of those that nothing in front of them hides
  double min_verified_score = 0.35;  ///< of what the view shows: explained less refuted
  double min_explained_px = 40;
  double min_confidence = 0.1;  ///< that the pose is right, see confidence.hpp
};

/// Weights of GRS(i) = (α·P_self + β·P_grasp)·P_system and of its terms.
struct GrsParameters {
  GraspOrder order = GraspOrder::kDescending;
  PSystem p_system = PSystem::kSupport;
  double alpha = 1.0;
  double beta = 20.0;                 ///< per m²
  double k1 = 5.0;                    ///< per m of height
  double k2 = 0.1;                    ///< of sin θ
  int neighbours_n = 4;               ///< K of P_grasp
  double isolation_distance_m = 0.3;  ///< of neighbours that do not exist
  int overlap_threshold_n = 50;       ///< template points of P_system's count
  double overlap_distance_m = 0.001;
  double confidence = 0;    ///< power of the registration's score that GRS is multiplied by
  double sure_score = 0.8;  ///< less probable objects come last in their layer
};

/// Who lies on whom. `over`: the columns in which one part is over another, as a share of those of
/// the smaller one.
struct PileParameters {
  double contact_m = 0.002;           ///< surfaces this near to each other touch
  double min_upward = 0.3;            ///< of a contact's unit normal: it bears weight
  double min_share = 0.05;            ///< of a part's weight: who bears less does not support it
  double min_entangled_over = 0.1;    ///< each over the other so much
  double min_double_pick_over = 0.3;  ///< so much over another: a lift may take it along
};

struct GraspParameters {
  double k3 = 1.0;   ///< of the distance to the barycentre
  double k4 = -0.5;  ///< of the distance to the nearest other object; below 0: farther is better
  double axis_step_m = 0.002;           ///< between the points on the principal axis that are tried
  double max_tilt_rad = 0.6;            ///< of the approach from the vertical
  double max_taught_tilt_rad = 1.0;     ///< where a taught point's cone allows no steeper approach
  double tilt_step_rad = 0.3;           ///< between the approaches that are tried
  double principal_axis_priority = -3;  ///< of the paper's grasp, among those of taught points
  int max_grasps_n = 32;
  int grasps_per_part_n = 3;       ///< free ones: the next ones of a part are not looked for
  int tries_per_part_n = 24;       ///< candidates that are checked, the preferred ones first
  double min_clearance_m = 0.002;  ///< on each side, where something leaves no room for more
};

/// Each check has its switch. Lengths are what the gripper keeps away by.
struct CollisionParameters {
  bool gripper_cloud = true;
  bool gripper_parts = true;
  bool gripper_bin = true;
  bool held_part = true;
  double cloud_tolerance_m = 0.006;    ///< a reading may be too near by
  double unexplained_tolerance_m = 0;  ///< the same of what neither a found part nor the floor is
  int edge_px = 2;                     ///< by which a silhouette may be smeared
  int hole_px = 4;          ///< from its rim, a hole in the image is as deep as what is seen there
  double margin_m = 0.002;  ///< from other parts: poses are no truer
  double lift_tolerance_m = 0.004;  ///< what lies no higher above the held part is not lifted
  double lift_overlap_m = 0.009;    ///< what overlaps with it less widely gives way
};

/// How the last plan's objects are looked for in a new frame.
enum class DisplacementCheck {
  kReadings,   ///< the readings at each object's last pose; of frames with a bin
  kCentroids,  ///< the paper's: the segments' centroids
};

struct DisplacementParameters {
  DisplacementCheck check = DisplacementCheck::kReadings;
  double threshold_m = 0.005;
};

struct Parameters {
  PreprocessParameters preprocess;
  SegmentationParameters segmentation;
  RegistrationParameters registration;
  GrsParameters grs;
  PileParameters pile;
  GraspParameters grasp;
  CollisionParameters collision;
  DisplacementParameters displacement;
};

}  // namespace graspd::perception

template <>
struct graspd::EnumNames<graspd::perception::DisplacementCheck> {
  static constexpr std::string_view what = "displacement check";
  static constexpr std::pair<perception::DisplacementCheck, std::string_view> values[] = {
      {perception::DisplacementCheck::kReadings, "readings"},
      {perception::DisplacementCheck::kCentroids, "centroids"}};
};
