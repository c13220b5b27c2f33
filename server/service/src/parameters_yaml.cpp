#include "graspd/service/parameters_yaml.hpp"

#include <fmt/format.h>

#include <cmath>

// The one place that maps perception's parameters to YAML: each is named once, with the range that
// makes sense, and the same visit reads and writes.
namespace graspd::service {
namespace {

using perception::Parameters;

template <class Visitor>
void visit(perception::PreprocessParameters& p, Visitor& section) {
  section.number("min_depth_m", p.min_depth_m, 0, 10);
  section.number("max_depth_m", p.max_depth_m, 0.01, 20);
  section.number("voxel_m", p.voxel_m, 0, 0.1);
  section.number("wall_margin_m", p.wall_margin_m, 0, 0.1);
  section.number("plane_tolerance_m", p.plane_tolerance_m, 1e-4, 0.1);
  section.number("plane_iterations_n", p.plane_iterations_n, 1, 100'000);
  section.number("plane_min_share", p.plane_min_share, 0, 1);
  section.number("max_behind_plane_share", p.max_behind_plane_share, 0, 1);
  section.number("normal_neighbours_n", p.normal_neighbours_n, 3, 1000);
}

template <class Visitor>
void visit(perception::SegmentationParameters& p, Visitor& section) {
  section.choice("method", p.method);
  section.number("eps_m", p.eps_m, 1e-4, 0.1);
  section.number("min_points_n", p.min_points_n, 1, 1000);
  section.number("octree_depth_n", p.octree_depth_n, 1, 16);
  section.number("smoothness_rad", p.smoothness_rad, 0, M_PI);
  section.number("curvature", p.curvature, 0, 1);
  section.number("euclidean_tolerance_m", p.euclidean_tolerance_m, 1e-4, 0.1);
  section.number("region_neighbours_n", p.region_neighbours_n, 3, 1000);
  section.number("region_smoothness_rad", p.region_smoothness_rad, 0, M_PI);
  section.number("region_curvature", p.region_curvature, 0, 1);
  section.number("min_segment_share", p.min_segment_share, 0, 1);
}

template <class Visitor>
void visit(perception::RegistrationParameters& p, Visitor& section) {
  section.choice("method", p.method);
  section.number("icp_iterations_n", p.icp_iterations_n, 1, 10'000);
  section.number("icp_max_distance_m", p.icp_max_distance_m, 1e-4, 1);
  section.number("inlier_tolerance_m", p.inlier_tolerance_m, 1e-4, 0.1);
  section.number("min_score", p.min_score, 0, 1);
  section.number("feature_radius_m", p.feature_radius_m, 1e-3, 1);
  section.number("sac_iterations_n", p.sac_iterations_n, 1, 1'000'000);
  section.number("ndt_resolution_m", p.ndt_resolution_m, 1e-3, 1);
}

template <class Visitor>
void visit(perception::GrsParameters& p, Visitor& section) {
  section.choice("order", p.order);
  section.choice("p_system", p.p_system);
  section.number("alpha", p.alpha, -1e6, 1e6);
  section.number("beta", p.beta, -1e6, 1e6);
  section.number("k1", p.k1, -1e6, 1e6);
  section.number("k2", p.k2, -1e6, 1e6);
  section.number("neighbours_n", p.neighbours_n, 1, 1000);
  section.number("overlap_threshold_n", p.overlap_threshold_n, 0, 1'000'000);
  section.number("overlap_distance_m", p.overlap_distance_m, 1e-4, 0.1);
}

template <class Visitor>
void visit(perception::GraspParameters& p, Visitor& section) {
  section.number("k3", p.k3, -1e6, 1e6);
  section.number("k4", p.k4, -1e6, 1e6);
  section.number("axis_step_m", p.axis_step_m, 1e-4, 0.1);
  section.number("max_grasps_n", p.max_grasps_n, 1, 1000);
}

template <class Visitor>
void visit(perception::DisplacementParameters& p, Visitor& section) {
  section.number("threshold_m", p.threshold_m, 0, 1);
}

template <class Visitor>
void visit(Parameters& p, Visitor& visitor) {
  visitor.section("preprocess", p.preprocess);
  visitor.section("segmentation", p.segmentation);
  visitor.section("registration", p.registration);
  visitor.section("grs", p.grs);
  visitor.section("grasp", p.grasp);
  visitor.section("displacement", p.displacement);
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
      map.fault(key, fmt::format("{} is outside {} … {}", value, low, high));
    }
  }
  template <class Enum>
  void choice(std::string_view key, Enum& value) {
    map.optional_enum(key, value);
  }
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
  void line(std::string_view key, const std::string& value) {
    text += fmt::format("{:{}}{}:{}\n", "", indent, key, value);
  }
};

}  // namespace

void read_parameters(YamlMap map, Parameters& parameters) {
  Reader reader{map};
  visit(parameters, reader);
}

std::string parameters_to_yaml(const Parameters& parameters, int indent) {
  Parameters copy = parameters;
  Writer writer{indent, {}};
  visit(copy, writer);
  return writer.text;
}

}  // namespace graspd::service
