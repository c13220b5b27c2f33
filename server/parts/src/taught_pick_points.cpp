#include "taught_pick_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "flat_patches.hpp"
#include "graspd/types/request.hpp"
#include "text.hpp"
#include "triangle_tree.hpp"

namespace graspd::parts {
namespace {

/// Finger tips may end beyond a flat part.
constexpr double kOverhang_m = 0.005;
/// Numbers are typed by hand, off a drawing; a mesh is tessellated.
constexpr double kTolerance_m = 0.001;
constexpr double kToleranceShare = 0.05;
constexpr double kMaxCupSkew_rad = 0.2;
/// The lines on which a jaw's width is measured, from its tip up.
constexpr int kLines = 6;
constexpr double kLineStep_m = 0.002;
constexpr double kPast_m = 1e-7;  // a triangle that was met

/// Along the closing direction, from the position.
struct Span {
  double from_m = 0;
  double to_m = 0;

  double width_m() const { return to_m - from_m; }
};

/// The solid about `p_m` along a line; where that is in a bore, the walls to either side of it.
std::optional<Span> span_at(const TriangleTree& tree, const Eigen::Vector3d& p_m,
                            const Eigen::Vector3d& line) {
  std::optional<Span> before;  // the last wall that ends before the position
  double entered_m = 0;
  const Eigen::Vector3d from_m = p_m - kOutside_m * line;
  double met_m = 0;
  for (auto hit = tree.first_hit(from_m, line); hit.triangle != nullptr;
       hit = tree.first_hit(from_m, line, met_m)) {
    met_m = hit.distance_m + kPast_m;
    const double at_m = hit.distance_m - kOutside_m;
    if (hit.triangle->area_vector_m2().dot(line) < 0) {
      entered_m = at_m;
    } else if (at_m < 0) {
      before = Span{entered_m, at_m};
    } else {
      const bool is_beyond = entered_m > 0;
      return Span{is_beyond && before ? before->from_m : entered_m, at_m};
    }
  }
  return before;
}

/// What jaws that close on the pick point meet: the widest span beside them.
std::optional<Span> span_between_jaws(const TriangleTree& tree, const PickPoint& point) {
  std::optional<Span> widest;
  // A little aside, so that a line along a face is not lost between inside and outside.
  const Eigen::Vector3d aside_m = 1e-6 * point.approach.cross(point.closing);
  for (int line = 0; line < kLines; ++line) {
    const double up_m = line * kLineStep_m;
    const auto span =
        span_at(tree, point.position_m + aside_m - up_m * point.approach, point.closing);
    if (span && (!widest || span->width_m() > widest->width_m())) widest = span;
  }
  return widest;
}

class PointCheck {
 public:
  explicit PointCheck(const Mesh& mesh) : tree_(mesh) {
    for (const auto& vertex_m : mesh.vertices_m) box_m_.extend(vertex_m.cast<double>());
  }

  /// \returns what contradicts the mesh; nothing where the point is right. Measures an absent
  /// width.
  std::string check(PickPoint& point) const {
    if (box_m_.exteriorDistance(point.position_m) > kOverhang_m) {
      return fmt::format(
          "position_mm {} lies outside of the mesh, which reaches from {} to {}; give it in the "
          "mesh's own frame, in millimetres",
          in_mm(point.position_m), in_mm(box_m_.min()), in_mm(box_m_.max()));
    }
    return point.gripper == name_of(GripperKind::kSuction) ? check_cup(point) : check_jaws(point);
  }

 private:
  std::string check_jaws(PickPoint& point) const {
    const auto span = span_between_jaws(tree_, point);
    if (!span) {
      return fmt::format(
          "nothing of the mesh lies between the jaws at position_mm {}; move it, or "
          "turn 'closing'",
          in_mm(point.position_m));
    }
    const double width_m = span->width_m();
    const double tolerance_m = std::max(kTolerance_m, kToleranceShare * width_m);
    const double aside_m = (span->from_m + span->to_m) / 2;
    if (std::abs(aside_m) > tolerance_m) {
      return fmt::format(
          "position_mm {} is not midway between the jaws, which meet the part {:.1f} "
          "mm and {:.1f} mm from it; {} is",
          in_mm(point.position_m), span->from_m * 1e3, span->to_m * 1e3,
          in_mm(point.position_m + aside_m * point.closing));
    }
    if (point.width_m == 0) point.width_m = width_m;
    if (std::abs(point.width_m - width_m) > tolerance_m) {
      return fmt::format(
          "width_mm is {:.4g}, but the mesh is {:.1f} mm wide between the jaws; write "
          "that, or leave width_mm out to have it measured",
          point.width_m * 1e3, width_m * 1e3);
    }
    return {};
  }

  std::string check_cup(PickPoint& point) const {
    const TriangleTree::Foot foot = tree_.nearest(point.position_m);
    const double away_m = std::sqrt(foot.squared_distance_m2);
    if (away_m > kTolerance_m) {
      return fmt::format(
          "a cup at position_mm {} would not touch: the surface is {:.1f} mm away, at "
          "{}",
          in_mm(point.position_m), away_m * 1e3, in_mm(foot.position_m));
    }
    const Eigen::Vector3d normal = foot.triangle->area_vector_m2().normalized();
    if (-normal.dot(point.approach) < std::cos(kMaxCupSkew_rad)) {
      return fmt::format(
          "'approach' must be square to the surface for a cup to seal; at position_mm {} that is "
          "{}",
          in_mm(point.position_m), in_digits(-normal));
    }
    const auto patch = flat_patch_at(tree_, foot.position_m, normal);
    if (!patch) {
      return fmt::format(
          "the surface about position_mm {} is too small or too curved for a cup; "
          "move it to where it is flat",
          in_mm(point.position_m));
    }
    if (point.width_m == 0) point.width_m = 2 * patch->radius_m;
    return {};
  }

  TriangleTree tree_;
  Eigen::AlignedBox3d box_m_;
};

}  // namespace

Result<std::vector<PickPoint>> taught_pick_points(const PartDescription& description,
                                                  const Mesh& mesh) {
  std::vector<PickPoint> points = description.pick_points;
  if (points.empty()) return points;
  const PointCheck checker(mesh);
  std::string faults;
  for (PickPoint& point : points) {
    const std::string fault = checker.check(point);
    if (fault.empty()) continue;
    faults += fmt::format("{}{}: pick point '{}': {}", faults.empty() ? "" : "\n",
                          description.file.string(), point.name, fault);
  }
  if (!faults.empty()) return invalid("{}", faults);
  return points;
}

}  // namespace graspd::parts
