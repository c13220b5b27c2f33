#include "graspd/perception/grasp_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

/// The template points, in the part's frame, that some approach may have between the jaws.
std::vector<Eigen::Vector3d> points_near(const PlacedPart& part, const Eigen::Vector3d& origin_m,
                                         const Gripper& gripper) {
  const double reach_m =
      Eigen::Vector3d(gripper.max_opening_m, gripper.jaw_size_m.y() / 2, gripper.jaw_size_m.z())
          .norm();
  const Eigen::Vector3d centre_m = part.T_floor_part.inverse() * origin_m;
  std::vector<Eigen::Vector3d> points_m;
  for (const auto& point : part.part->surface) {
    const Eigen::Vector3d p_m = point.position_m.cast<double>();
    if ((p_m - centre_m).squaredNorm() <= reach_m * reach_m) points_m.push_back(p_m);
  }
  return points_m;
}

/// How wide the part is between the jaws: the extent along x of the points that lie between them.
std::optional<double> width_between_jaws_m(std::span<const Eigen::Vector3d> points_m,
                                           const Eigen::Isometry3d& T_grasp_part,
                                           const Gripper& gripper) {
  const double half_jaw_m = gripper.jaw_size_m.y() / 2;
  double reach_m = -1;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d p = T_grasp_part * point_m;
    const bool beside_jaw =
        std::abs(p.y()) <= half_jaw_m && p.z() <= 0 && p.z() >= -gripper.jaw_size_m.z();
    // The jaws close on the origin: the wider side decides for both.
    if (beside_jaw) reach_m = std::max(reach_m, std::abs(p.x()));
  }
  if (reach_m < 0) return std::nullopt;
  return 2 * reach_m;
}

}  // namespace

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

std::vector<GraspCandidate> grasp_candidates(std::size_t target, std::span<const PlacedPart> parts,
                                             const Gripper& gripper,
                                             const GraspParameters& parameters) {
  const PlacedPart& object = parts[target];
  const Eigen::Vector3d origin_m = grasp_point(target, parts, parameters);
  const Eigen::Vector3d closing = closing_direction(object);
  const std::vector<Eigen::Vector3d> points_m = points_near(object, origin_m, gripper);
  std::vector<GraspCandidate> candidates;
  for (const Eigen::Vector3d& approach : approaches(parameters)) {
    GraspCandidate candidate{"principal_axis", grasp_frame(origin_m, approach, closing), 0,
                             -approach.z()};
    const auto width_m = width_between_jaws_m(
        points_m, candidate.T_floor_grasp.inverse() * object.T_floor_part, gripper);
    if (!width_m) continue;
    candidate.width_m = *width_m;
    candidates.push_back(candidate);
  }
  return candidates;
}

}  // namespace graspd::perception
