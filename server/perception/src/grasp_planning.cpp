#include "graspd/perception/grasp_planning.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace graspd::perception {
namespace {

constexpr int kTiltDirections = 8;

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
