#include "graspd/perception/grasp_planning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace graspd::perception {
namespace {

constexpr int kTiltDirections = 8;
/// An axis this near to the vertical has no closing direction of its own.
constexpr double kVerticalAxis_rad = 1.3;

struct AxisExtent {
  double low_m = 0, high_m = 0;
};

AxisExtent extent_along(const PlacedPart& part, const Eigen::Vector3d& axis) {
  AxisExtent extent{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  const Eigen::Vector3d barycentre_m = part.barycentre_m();
  for (const auto& point : part.part->surface) {
    const Eigen::Vector3d p = part.T_floor_part * point.position_m.cast<double>();
    const double along_m = axis.dot(p - barycentre_m);
    extent.low_m = std::min(extent.low_m, along_m);
    extent.high_m = std::max(extent.high_m, along_m);
  }
  return extent;
}

/// dn at each point: the distance to the nearest template point of another part.
std::vector<double> distances_to_others(std::span<const Eigen::Vector3d> points_m,
                                        std::size_t target, std::span<const PlacedPart> parts) {
  const auto gap_m = [&](std::size_t other) {
    return (parts[other].barycentre_m() - parts[target].barycentre_m()).norm() -
           parts[other].part->radius_m - parts[target].part->radius_m;
  };
  std::vector<std::pair<double, std::size_t>> others;  // at least this far away, nearest first
  for (std::size_t other = 0; other < parts.size(); ++other) {
    if (other != target) others.emplace_back(std::max(0.0, gap_m(other)), other);
  }
  std::sort(others.begin(), others.end());

  std::vector<float> x_m, y_m, z_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    x_m.push_back(static_cast<float>(point_m.x()));
    y_m.push_back(static_cast<float>(point_m.y()));
    z_m.push_back(static_cast<float>(point_m.z()));
  }
  std::vector<float> nearest2(points_m.size(), std::numeric_limits<float>::max());
  for (const auto& [least_m, other] : others) {
    const auto farthest2 = static_cast<double>(*std::max_element(nearest2.begin(), nearest2.end()));
    if (least_m * least_m > farthest2) break;
    const Eigen::Isometry3f T_floor_other = parts[other].T_floor_part.cast<float>();
    for (const auto& point : parts[other].part->surface) {
      const Eigen::Vector3f p = T_floor_other * point.position_m;
      // Plain arrays: the compiler makes vectors of them.
      for (std::size_t i = 0; i < points_m.size(); ++i) {
        const float dx = p.x() - x_m[i];
        const float dy = p.y() - y_m[i];
        const float dz = p.z() - z_m[i];
        const float distance2 = dx * dx + dy * dy + dz * dz;
        nearest2[i] = distance2 < nearest2[i] ? distance2 : nearest2[i];
      }
    }
  }
  std::vector<double> distances_m;
  for (const float distance2 : nearest2) distances_m.push_back(std::sqrt(double{distance2}));
  return distances_m;
}

/// Grasp frame with the given approach (z) whose closing direction (x) is the nearest to `closing`.
Eigen::Isometry3d grasp_frame(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& approach,
                              const Eigen::Vector3d& closing) {
  const Eigen::Vector3d z = approach.normalized();
  const Eigen::Vector3d x = (closing - z * z.dot(closing)).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = origin_m;
  return T;
}

/// Straight down first, then tilts by growing angles in all directions.
std::vector<Eigen::Vector3d> approaches(const GraspParameters& parameters) {
  std::vector<Eigen::Vector3d> directions{-Eigen::Vector3d::UnitZ()};
  // The small summand: 0.6 / 0.1 is below 6.
  const auto tilts_n = static_cast<int>(parameters.max_tilt_rad / parameters.tilt_step_rad + 1e-9);
  for (int k = 1; k <= tilts_n; ++k) {
    const double tilt = k * parameters.tilt_step_rad;
    for (int i = 0; i < kTiltDirections; ++i) {
      const double azimuth = 2 * M_PI * i / kTiltDirections;
      directions.emplace_back(std::sin(tilt) * std::cos(azimuth),
                              std::sin(tilt) * std::sin(azimuth), -std::cos(tilt));
    }
  }
  return directions;
}

/// Across the principal axis, in the horizontal plane; across the second axis where the first
/// stands upright.
Eigen::Vector3d closing_direction(const PlacedPart& part) {
  Eigen::Vector3d axis = part.principal_axis();
  if (inclination_rad(axis) > kVerticalAxis_rad) {
    axis = part.T_floor_part.linear() * part.part->principal_axes.col(1);
  }
  return Eigen::Vector3d::UnitZ().cross(axis).normalized();
}

CheckReport report(Check check, bool passed, std::string reason) {
  if (passed) return {check, CheckState::kPassed, {}};
  return {check, CheckState::kFailed, std::move(reason)};
}

CheckReport check_opening(const std::optional<double>& width_m, const Gripper& gripper) {
  if (!width_m) return report(Check::kOpening, false, "there is nothing between the jaws");
  const double opening_m = *width_m + 2 * gripper.clearance_m;
  return report(Check::kOpening, opening_m <= gripper.max_opening_m,
                fmt::format("the part is {:.1f} mm wide here and needs {:.1f} mm, the gripper "
                            "opens {:.1f} mm",
                            *width_m * 1e3, opening_m * 1e3, gripper.max_opening_m * 1e3));
}

}  // namespace

bool PlannedGrasp::is_free() const {
  return std::none_of(checks.begin(), checks.end(),
                      [](const CheckReport& check) { return check.state == CheckState::kFailed; });
}

Eigen::Vector3d grasp_point(std::size_t target, std::span<const PlacedPart> parts,
                            const GraspParameters& parameters) {
  const PlacedPart& object = parts[target];
  if (parts.size() < 2) return object.barycentre_m();
  const Eigen::Vector3d barycentre_m = object.barycentre_m();
  const Eigen::Vector3d axis = object.principal_axis();
  const AxisExtent extent = extent_along(object, axis);
  // Steps are counted from the barycentre, so that it is among the candidates.
  std::vector<Eigen::Vector3d> candidates_m;
  const auto first = static_cast<int>(std::ceil(extent.low_m / parameters.axis_step_m));
  const auto last = static_cast<int>(std::floor(extent.high_m / parameters.axis_step_m));
  for (int i = first; i <= last; ++i) {
    candidates_m.push_back(barycentre_m + axis * (i * parameters.axis_step_m));
  }
  const std::vector<double> dn_m = distances_to_others(candidates_m, target, parts);
  Eigen::Vector3d best = barycentre_m;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < candidates_m.size(); ++i) {
    const double de_m = (candidates_m[i] - barycentre_m).norm();
    const double cost = parameters.k3 * de_m + parameters.k4 * dn_m[i];
    if (cost >= least) continue;
    least = cost;
    best = candidates_m[i];
  }
  return best;
}

std::optional<double> width_between_jaws_m(const PlacedPart& part,
                                           const Eigen::Isometry3d& T_floor_grasp,
                                           const Gripper& gripper) {
  const Eigen::Isometry3d T_grasp_part = T_floor_grasp.inverse() * part.T_floor_part;
  const double half_jaw_m = gripper.jaw_size_m.y() / 2;
  double reach_m = -1;
  for (const auto& point : part.part->surface) {
    const Eigen::Vector3d p = T_grasp_part * point.position_m.cast<double>();
    const bool beside_jaw =
        std::abs(p.y()) <= half_jaw_m && p.z() <= 0 && p.z() >= -gripper.jaw_size_m.z();
    // The jaws close on the origin: the wider side decides for both.
    if (beside_jaw) reach_m = std::max(reach_m, std::abs(p.x()));
  }
  if (reach_m < 0) return std::nullopt;
  return 2 * reach_m;
}

bool gripper_inside_bin(const Eigen::Isometry3d& T_floor_grasp, double opening_width_m,
                        const Gripper& gripper, const Eigen::Vector3d& bin_inner_size_m) {
  // Both jaws in one box, and the palm above it; a box is inside where its corners are, and above
  // the rim there is no wall.
  const double half_x_m = opening_width_m / 2 + gripper.jaw_size_m.x();
  const double jaw_top_m = -gripper.jaw_size_m.z();
  const std::array<Eigen::AlignedBox3d, 2> boxes = {
      Eigen::AlignedBox3d(Eigen::Vector3d(-half_x_m, -gripper.jaw_size_m.y() / 2, jaw_top_m),
                          Eigen::Vector3d(half_x_m, gripper.jaw_size_m.y() / 2, 0)),
      Eigen::AlignedBox3d(
          Eigen::Vector3d(-gripper.palm_size_m.x() / 2, -gripper.palm_size_m.y() / 2,
                          jaw_top_m - gripper.palm_size_m.z()),
          Eigen::Vector3d(gripper.palm_size_m.x() / 2, gripper.palm_size_m.y() / 2, jaw_top_m))};
  for (const auto& box : boxes) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p =
          T_floor_grasp * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      if (p.z() < 0) return false;
      const bool beyond_wall =
          std::abs(p.x()) > bin_inner_size_m.x() / 2 || std::abs(p.y()) > bin_inner_size_m.y() / 2;
      if (p.z() < bin_inner_size_m.z() && beyond_wall) return false;
    }
  }
  return true;
}

PlannedGrasp plan_grasp(std::size_t target, std::span<const PlacedPart> parts,
                        const std::optional<Eigen::Vector3d>& bin_inner_size_m,
                        const Gripper& gripper, const GraspParameters& parameters) {
  const PlacedPart& object = parts[target];
  const Eigen::Vector3d origin_m = grasp_point(target, parts, parameters);
  const Eigen::Vector3d closing = closing_direction(object);

  const auto grasp_along = [&](const Eigen::Vector3d& approach) {
    PlannedGrasp grasp;
    grasp.T_floor_grasp = grasp_frame(origin_m, approach, closing);
    const auto width_m = width_between_jaws_m(object, grasp.T_floor_grasp, gripper);
    grasp.opening_width_m = std::clamp(width_m.value_or(0) + 2 * gripper.clearance_m,
                                       gripper.min_opening_m, gripper.max_opening_m);
    grasp.checks.push_back(check_opening(width_m, gripper));
    if (bin_inner_size_m) {
      const bool inside = gripper_inside_bin(grasp.T_floor_grasp, grasp.opening_width_m, gripper,
                                             *bin_inner_size_m);
      grasp.checks.push_back(
          report(Check::kGripperBin, inside, "jaws or palm cross a wall or the floor of the bin"));
    } else {
      grasp.checks.push_back({Check::kGripperBin, CheckState::kNotRun, "no bin was given"});
    }
    return grasp;
  };

  const std::vector<Eigen::Vector3d> directions = approaches(parameters);
  PlannedGrasp chosen = grasp_along(directions.front());
  for (std::size_t i = 1; i < directions.size() && !chosen.is_free(); ++i) {
    if (PlannedGrasp tilted = grasp_along(directions[i]); tilted.is_free()) chosen = tilted;
  }
  for (const Check check : {Check::kGripperCloud, Check::kGripperParts, Check::kHeldPart}) {
    chosen.checks.push_back({check, CheckState::kNotRun, "this version does not have this check"});
  }
  return chosen;
}

}  // namespace graspd::perception
