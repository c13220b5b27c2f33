#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "graspd/formats/yaml.hpp"
#include "graspd/parts/part.hpp"
#include "graspd/parts/part_version.hpp"
#include "graspd/types/request.hpp"
#include "symmetry_group.hpp"

namespace graspd::parts {
namespace {

constexpr double kMetresPerMm = 1e-3;
constexpr double kRadPerDeg = std::numbers::pi / 180;
// Axes are typed by hand, with few digits.
constexpr double kMaxSkewCosine = 0.02;
// Long-stroke parallel grippers open to 0.3 m.
constexpr double kWidestGripper_m = 0.3;

bool is_id(const std::string& id) {
  return !id.empty() && std::all_of(id.begin(), id.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
}

/// Leaves `direction` as it is where the key is absent.
void read_direction(YamlMap& map, std::string_view key, Eigen::Vector3d& direction) {
  map.optional(key, direction);
  if (direction.norm() > 1e-9) {
    direction.normalize();
  } else {
    map.fault(key, fmt::format("'{}' must be a direction: three numbers, not all 0", key));
  }
}

void read_point_mm(YamlMap& map, std::string_view key, Eigen::Vector3d& point_m) {
  Eigen::Vector3d point_mm = point_m / kMetresPerMm;
  map.optional(key, point_mm);
  point_m = point_mm * kMetresPerMm;
}

ContinuousSymmetry read_continuous(YamlMap map) {
  ContinuousSymmetry symmetry;
  if (!map.has("axis")) map.fault({}, "key 'axis' is missing");
  read_direction(map, "axis", symmetry.axis);
  read_point_mm(map, "point_mm", symmetry.point_m);
  return symmetry;
}

Eigen::Isometry3d read_discrete(YamlMap map) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (map.has("T_mm")) {
    map.required("T_mm", T);
    T.translation() *= kMetresPerMm;
    return T;
  }
  double angle_deg = 0;
  const ContinuousSymmetry turn = read_continuous(map);
  map.required("angle_deg", angle_deg);
  T.linear() = Eigen::AngleAxisd(angle_deg * kRadPerDeg, turn.axis).toRotationMatrix();
  T.translation() = turn.point_m - T.linear() * turn.point_m;
  return T;
}

Symmetries read_symmetries(YamlMap map) {
  Symmetries symmetries;
  std::vector<Eigen::Isometry3d> generators;
  for (YamlMap& entry : map.list_of_maps("discrete")) generators.push_back(read_discrete(entry));
  if (auto group = close_group(generators)) {
    symmetries.discrete = std::move(*group);
  } else {
    map.fault("discrete", group.error().message);
  }
  for (YamlMap& entry : map.list_of_maps("continuous")) {
    symmetries.continuous.push_back(read_continuous(entry));
  }
  return symmetries;
}

/// The closing direction is a line across the approach: take out what a rounded digit left.
void square_up(YamlMap& map, PickPoint& point) {
  const double cosine = point.closing.dot(point.approach);
  if (std::abs(cosine) > kMaxSkewCosine) {
    map.fault("closing",
              fmt::format("pick point '{}': 'closing' must be at right angles to "
                          "'approach'; it is at {:.1f}°",
                          point.name, std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadPerDeg));
    return;
  }
  point.closing = (point.closing - cosine * point.approach).normalized();
}

/// The names of what is not taught.
bool is_reserved(const std::string& name) {
  return name == "principal_axis" || name.starts_with("antipodal_") || name.starts_with("flat_");
}

PickPoint read_pick_point(YamlMap map) {
  PickPoint point;
  double cone_deg = point.approach_cone_rad / kRadPerDeg;
  double width_mm = 0;
  map.required("name", point.name);
  if (!map.has("position_mm")) map.fault({}, "key 'position_mm' is missing");
  read_point_mm(map, "position_mm", point.position_m);
  read_direction(map, "approach", point.approach);
  read_direction(map, "closing", point.closing);
  map.optional("approach_cone_deg", cone_deg);
  map.optional("width_mm", width_mm);
  map.optional("priority", point.priority);
  map.optional("gripper", point.gripper);
  if (!(cone_deg > 0 && cone_deg <= 180)) {
    map.fault("approach_cone_deg",
              fmt::format("pick point '{}': 'approach_cone_deg' is {}: it must be above 0, or no "
                          "pose of the part can be grasped there, and at most 180, which is any "
                          "approach",
                          point.name, cone_deg));
  }
  if (!(width_mm >= 0 && width_mm <= kWidestGripper_m / kMetresPerMm)) {
    map.fault("width_mm", fmt::format("pick point '{}': 'width_mm' is {}: it must be from 0, which "
                                      "has it measured, to {}, as wide as any gripper opens",
                                      point.name, width_mm, kWidestGripper_m / kMetresPerMm));
  }
  if (!point.gripper.empty() && !parse_enum<GripperKind>(point.gripper)) {
    map.fault("gripper", fmt::format("'{}' is no {}; known: {}", point.gripper,
                                     EnumNames<GripperKind>::what, names_of<GripperKind>()));
  }
  if (point.gripper != name_of(GripperKind::kSuction)) square_up(map, point);
  point.approach_cone_rad = cone_deg * kRadPerDeg;
  point.width_m = width_mm * kMetresPerMm;
  return point;
}

std::vector<PickPoint> read_pick_points(YamlMap root) {
  std::vector<PickPoint> points;
  std::set<std::string> names;
  for (YamlMap& entry : root.list_of_maps("pick_points")) {
    points.push_back(read_pick_point(entry));
    const std::string& name = points.back().name;
    if (!names.insert(name).second) {
      entry.fault("name", fmt::format("two pick points are named '{}'", name));
    }
    if (is_reserved(name)) {
      entry.fault("name", fmt::format("'{}' is what graspd calls a pick point of its own; teach it "
                                      "by another name",
                                      name));
    }
  }
  return points;
}

void read_color(YamlMap& root, std::array<std::uint8_t, 3>& color_rgb) {
  std::vector<double> values(color_rgb.begin(), color_rgb.end());
  root.optional("color_rgb", values);
  const bool are_bytes = std::all_of(values.begin(), values.end(), [](double v) {
    return v >= 0 && v <= 255 && v == std::floor(v);
  });
  if (values.size() != color_rgb.size() || !are_bytes) {
    root.fault("color_rgb", "'color_rgb' must be three whole numbers from 0 to 255");
    return;
  }
  for (std::size_t i = 0; i < color_rgb.size(); ++i) {
    color_rgb[i] = static_cast<std::uint8_t>(values[i]);
  }
}

/// For people, and for who writes part files: the planner does not ask for it.
int read_version(YamlMap& root) {
  int version = 1;
  root.optional("version", version);
  if (version < 1) root.fault("version", "'version' must be 1 or more");
  return version;
}

}  // namespace

int read_part_version(const std::filesystem::path& path) {
  YamlDocument document(path);
  YamlMap root = document.root();
  return read_version(root);
}

Result<PartDescription> read_part_file(const std::filesystem::path& path) {
  YamlDocument document(path);
  YamlMap root = document.root();
  PartDescription part;
  part.file = path;
  root.required("id", part.id);
  part.name = part.id;
  root.optional("name", part.name);
  root.optional("bop_obj_id", part.bop_obj_id);
  std::string mesh;
  root.required("mesh", mesh);
  part.mesh_file = path.parent_path() / mesh;
  // No default: a guessed unit is a part of a thousand times the size.
  if (!root.has("mesh_unit")) root.fault({}, "key 'mesh_unit' is missing");
  root.optional_enum("mesh_unit", part.mesh_unit);
  read_color(root, part.color_rgb);
  read_version(root);
  if (root.has("symmetries")) part.symmetries = read_symmetries(root.map("symmetries"));
  part.pick_points = read_pick_points(root);
  if (root.has("id") && !is_id(part.id)) {
    root.fault("id", "'id' must be made of letters, digits, '_', '-' and '.'");
  }
  if (part.bop_obj_id < 0) root.fault("bop_obj_id", "'bop_obj_id' must not be below 0");
  if (auto read = document.finish(); !read) return tl::unexpected(read.error());
  return part;
}

}  // namespace graspd::parts
