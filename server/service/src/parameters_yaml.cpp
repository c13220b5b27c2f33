#include "graspd/service/parameters_yaml.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "graspd/parts/contact_model.hpp"

// The one place that maps perception's parameters to YAML: each has one line here with the range
// that makes sense, and the same visit reads and writes. The bindings name every member, so that a
// parameter which is added to a struct and forgotten here does not compile.
namespace graspd::service {
namespace {

using perception::Parameters;

template <class Visitor>
void visit(perception::PreprocessParameters& p, Visitor& section) {
  auto& [min_depth_m, max_depth_m, voxel_m, wall_margin_m, heap_m, plane_tolerance_m,
         plane_iterations_n, plane_min_share, max_behind_plane_share, normal_neighbours_n,
         wall_bow_m, find_wall_bow, wall_reach_m, bin_drift_warning_m, max_bin_drift_m] = p;
  section.number("min_depth_m", min_depth_m, 0, 10);
  section.number("max_depth_m", max_depth_m, 0.01, 20);
  section.number("voxel_m", voxel_m, 0, 0.1);
  section.number("wall_margin_m", wall_margin_m, 0, 0.1);
  section.number("heap_m", heap_m, 0, 10);
  section.number("plane_tolerance_m", plane_tolerance_m, 1e-4, 0.1);
  section.number("plane_iterations_n", plane_iterations_n, 1, 100'000);
  section.number("plane_min_share", plane_min_share, 0, 1);
  section.number("max_behind_plane_share", max_behind_plane_share, 0, 1);
  section.number("normal_neighbours_n", normal_neighbours_n, 3, 1000);
  section.number("wall_bow_m", wall_bow_m, 0, perception::kMaxWallBow_m);
  section.flag("find_wall_bow", find_wall_bow);
  section.number("wall_reach_m", wall_reach_m, 1e-3, 1);
  section.number("bin_drift_warning_m", bin_drift_warning_m, 0, 1);
  section.number("max_bin_drift_m", max_bin_drift_m, 0, 1);
}

template <class Visitor>
void visit(perception::SegmentationParameters& p, Visitor& section) {
  auto& [method, grid_eps_px, grid_min_points_n, eps_m, min_points_n, octree_depth_n,
         smoothness_rad, curvature, euclidean_tolerance_m, region_neighbours_n,
         region_smoothness_rad, region_curvature, min_segment_share] = p;
  section.choice("method", method);
  section.number("grid_eps_px", grid_eps_px, 1, 20);
  section.number("grid_min_points_n", grid_min_points_n, 1, 1000);
  section.number("eps_m", eps_m, 1e-4, 0.1);
  section.number("min_points_n", min_points_n, 1, 1000);
  section.number("octree_depth_n", octree_depth_n, 1, 16);
  section.number("smoothness_rad", smoothness_rad, 0, M_PI);
  section.number("curvature", curvature, 0, 1);
  section.number("euclidean_tolerance_m", euclidean_tolerance_m, 1e-4, 0.1);
  section.number("region_neighbours_n", region_neighbours_n, 3, 1000);
  section.number("region_smoothness_rad", region_smoothness_rad, 0, M_PI);
  section.number("region_curvature", region_curvature, 0, 1);
  section.number("min_segment_share", min_segment_share, 0, 1);
}

template <class Visitor>
void visit(perception::RegistrationParameters& p, Visitor& section) {
  auto& [method, icp_iterations_n, icp_max_distance_m, inlier_tolerance_m, min_score,
         max_below_floor_m, feature_radius_m, sac_iterations_n, ndt_resolution_m, seed_spacing_m,
         normal_tolerance_rad, templates_per_seed_n, hypotheses_per_seed_n, coarse_tolerance_m,
         min_coarse_score, coarse_per_place_n, fine_per_place_n, refuted_weight, max_leftover_share,
         min_visible_share, min_unhidden_share, min_verified_score, min_explained_px,
         min_confidence] = p;
  section.choice("method", method);
  section.number("icp_iterations_n", icp_iterations_n, 1, 10'000);
  section.number("icp_max_distance_m", icp_max_distance_m, 1e-4, 1);
  section.number("inlier_tolerance_m", inlier_tolerance_m, 1e-4, 0.1);
  section.number("min_score", min_score, 0, 1);
  section.number("max_below_floor_m", max_below_floor_m, 0, 1);
  section.number("feature_radius_m", feature_radius_m, 1e-3, 1);
  section.number("sac_iterations_n", sac_iterations_n, 1, 1'000'000);
  section.number("ndt_resolution_m", ndt_resolution_m, 1e-3, 1);
  section.number("seed_spacing_m", seed_spacing_m, 1e-3, 1);
  section.number("normal_tolerance_rad", normal_tolerance_rad, 0, M_PI);
  section.number("templates_per_seed_n", templates_per_seed_n, 1, 10'000);
  section.number("hypotheses_per_seed_n", hypotheses_per_seed_n, 1, 1000);
  section.number("coarse_tolerance_m", coarse_tolerance_m, 1e-4, 1);
  section.number("min_coarse_score", min_coarse_score, 0, 1);
  section.number("coarse_per_place_n", coarse_per_place_n, 1, 1000);
  section.number("fine_per_place_n", fine_per_place_n, 1, 1000);
  section.number("refuted_weight", refuted_weight, 0, 100);
  section.number("max_leftover_share", max_leftover_share, 0, 1);
  section.number("min_visible_share", min_visible_share, 0, 1);
  section.number("min_unhidden_share", min_unhidden_share, 0, 1);
  section.number("min_verified_score", min_verified_score, 0, 1);
  section.number("min_explained_px", min_explained_px, 0, 1e6);
  section.number("min_confidence", min_confidence, 0, 1);
}

template <class Visitor>
void visit(perception::GrsParameters& p, Visitor& section) {
  auto& [order, p_system, alpha, beta, k1, k2, neighbours_n, isolation_distance_m,
         overlap_threshold_n, overlap_distance_m, confidence, sure_score] = p;
  section.choice("order", order);
  section.choice("p_system", p_system);
  section.number("alpha", alpha, -1e6, 1e6);
  section.number("beta", beta, -1e6, 1e6);
  section.number("k1", k1, -1e6, 1e6);
  section.number("k2", k2, -1e6, 1e6);
  section.number("neighbours_n", neighbours_n, 1, 1000);
  section.number("isolation_distance_m", isolation_distance_m, 0, 10);
  section.number("overlap_threshold_n", overlap_threshold_n, 0, 1'000'000);
  section.number("overlap_distance_m", overlap_distance_m, 1e-4,
                 parts::ContactModel::kMaxDistance_m);
  section.number("confidence", confidence, 0, 10);
  section.number("sure_score", sure_score, 0, 1);
}

template <class Visitor>
void visit(perception::PileParameters& p, Visitor& section) {
  auto& [contact_m, min_upward, min_share, min_entangled_over, min_double_pick_over] = p;
  section.number("contact_m", contact_m, 1e-4, parts::ContactModel::kMaxDistance_m);
  section.number("min_upward", min_upward, 0, 1);
  section.number("min_share", min_share, 0, 1);
  section.number("min_entangled_over", min_entangled_over, 0, 1);
  section.number("min_double_pick_over", min_double_pick_over, 0, 1);
}

template <class Visitor>
void visit(perception::GraspParameters& p, Visitor& section) {
  auto& [k3, k4, axis_step_m, max_tilt_rad, max_taught_tilt_rad, tilt_step_rad,
         principal_axis_priority, max_grasps_n, grasps_per_part_n, tries_per_part_n,
         min_clearance_m] = p;
  section.number("k3", k3, -1e6, 1e6);
  section.number("k4", k4, -1e6, 1e6);
  section.number("axis_step_m", axis_step_m, 1e-4, 0.1);
  section.number("max_tilt_rad", max_tilt_rad, 0, M_PI / 2);
  section.number("max_taught_tilt_rad", max_taught_tilt_rad, 0, M_PI / 2);
  section.number("tilt_step_rad", tilt_step_rad, 0.01, M_PI / 2);
  section.number("principal_axis_priority", principal_axis_priority, -1e6, 1e6);
  section.number("max_grasps_n", max_grasps_n, 1, 1000);
  section.number("grasps_per_part_n", grasps_per_part_n, 1, 100);
  section.number("tries_per_part_n", tries_per_part_n, 1, 10'000);
  section.number("min_clearance_m", min_clearance_m, 0, 0.1);
}

template <class Visitor>
void visit(perception::CollisionParameters& p, Visitor& section) {
  auto& [gripper_cloud, gripper_parts, gripper_bin, held_part, cloud_tolerance_m,
         unexplained_tolerance_m, edge_px, hole_px, margin_m, lift_tolerance_m, lift_overlap_m] = p;
  section.flag("gripper_cloud", gripper_cloud);
  section.flag("gripper_parts", gripper_parts);
  section.flag("gripper_bin", gripper_bin);
  section.flag("held_part", held_part);
  section.number("cloud_tolerance_m", cloud_tolerance_m, 0, 0.1);
  section.number("unexplained_tolerance_m", unexplained_tolerance_m, 0, 0.1);
  section.number("edge_px", edge_px, 0, 20);
  section.number("hole_px", hole_px, 0, 100);
  section.number("margin_m", margin_m, 0, 0.1);
  section.number("lift_tolerance_m", lift_tolerance_m, 0, 0.1);
  section.number("lift_overlap_m", lift_overlap_m, 1e-3, 0.1);
}

template <class Visitor>
void visit(perception::DisplacementParameters& p, Visitor& section) {
  auto& [check, threshold_m] = p;
  section.choice("check", check);
  section.number("threshold_m", threshold_m, 0, 1);
}

template <class Visitor>
void visit(Parameters& p, Visitor& visitor) {
  auto& [preprocess, segmentation, registration, grs, pile, grasp, collision, displacement] = p;
  visitor.section("preprocess", preprocess);
  visitor.section("segmentation", segmentation);
  visitor.section("registration", registration);
  visitor.section("grs", grs);
  visitor.section("pile", pile);
  visitor.section("grasp", grasp);
  visitor.section("collision", collision);
  visitor.section("displacement", displacement);
}

struct Reader {
  YamlMap map;

  template <class Section>
  void section(std::string_view name, Section& parameters) {
    Reader reader{map.map(name)};
    visit(parameters, reader);
  }
  template <class Number>
  void number(std::string_view key, Number& value, double low, double high) {
    map.optional(key, value);
    const auto number = static_cast<double>(value);
    if (!(number >= low && number <= high)) {
      map.fault(key, fmt::format("{}: {} is outside {} … {}", key, value, low, high));
    }
  }
  template <class Enum>
  void choice(std::string_view key, Enum& value) {
    map.optional_enum(key, value);
  }
  void flag(std::string_view key, bool& value) { map.optional(key, value); }
};

struct Writer {
  int indent;
  std::string text;

  template <class Section>
  void section(std::string_view name, Section& parameters) {
    line(name, "");
    Writer writer{indent + 2, {}};
    visit(parameters, writer);
    text += writer.text;
  }
  template <class Number>
  void number(std::string_view key, Number& value, double, double) {
    line(key, fmt::format(" {}", value));
  }
  template <class Enum>
  void choice(std::string_view key, Enum& value) {
    line(key, fmt::format(" {}", name_of(value)));
  }
  void flag(std::string_view key, bool& value) { line(key, fmt::format(" {}", value)); }
  void line(std::string_view key, const std::string& value) {
    text += fmt::format("{:{}}{}:{}\n", "", indent, key, value);
  }
};

}  // namespace

void read_parameters(YamlMap map, Parameters& parameters) {
  Reader reader{std::move(map)};
  visit(parameters, reader);
}

std::string parameters_to_yaml(const Parameters& parameters, int indent) {
  Parameters copy = parameters;
  Writer writer{indent, {}};
  visit(copy, writer);
  return writer.text;
}

}  // namespace graspd::service
