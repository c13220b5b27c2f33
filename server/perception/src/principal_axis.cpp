#include "graspd/perception/principal_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace graspd::perception {
namespace {

/// An axis this near to the vertical has no closing direction of its own.
constexpr double kVerticalAxis_rad = 1.3;
/// So many times as far as outside: more than any part is wide from a micrometre on.
constexpr float kOutside = 1e6F;
constexpr std::size_t kLanes = parts::SphereArrays::kPadding;  // points at a time
using Lanes = Eigen::Array<float, kLanes, 1>;

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

}  // namespace

Eigen::Vector3d closing_direction(const PlacedPart& part) {
  Eigen::Vector3d axis = part.principal_axis();
  if (inclination_rad(axis) > kVerticalAxis_rad) {
    axis = part.T_floor_part.linear() * part.part->principal_axes.col(1);
  }
  return Eigen::Vector3d::UnitZ().cross(axis).normalized();
}

Eigen::Vector3d grasp_point(std::size_t target, std::span<const PlacedPart> parts,
                            const GraspParameters& parameters) {
  const PlacedPart& object = parts[target];
  // dn changes by no more than one goes along the axis: with |k4| ≤ k3, nothing is gained by going.
  const bool stays = std::abs(parameters.k4) <= parameters.k3;
  if (parts.size() < 2 || stays) return object.barycentre_m();
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
  const Eigen::Matrix4f T_grasp_part =
      (T_floor_grasp.inverse() * part.T_floor_part).matrix().cast<float>();
  const auto half_jaw_m = static_cast<float>(gripper.jaw_size_m.y() / 2);
  const auto jaw_length_m = static_cast<float>(gripper.jaw_size_m.z());
  const parts::SphereArrays& points = part.part->contact.point_spheres();
  Lanes reach_m = Lanes::Constant(-1);
  // The last ones are the padding, which repeats a point.
  for (std::size_t first = 0; first < points.size; first += kLanes) {
    const Eigen::Map<const Lanes> x_m(&points.x_m[first]);
    const Eigen::Map<const Lanes> y_m(&points.y_m[first]);
    const Eigen::Map<const Lanes> z_m(&points.z_m[first]);
    const auto along = [&](int axis) -> Lanes {
      return T_grasp_part(axis, 0) * x_m + T_grasp_part(axis, 1) * y_m +
             T_grasp_part(axis, 2) * z_m + T_grasp_part(axis, 3);
    };
    const Lanes below_m = along(2);
    const Lanes beside_m = along(1).abs() - half_jaw_m;
    const Lanes outside_m = beside_m.max(below_m).max(-jaw_length_m - below_m).max(0.0F);
    // A point outside of what is between the jaws counts for less than nothing.
    reach_m = reach_m.max(along(0).abs() - kOutside * outside_m);
  }
  // The jaws close on the origin: the wider side decides for both.
  const float widest_m = reach_m.maxCoeff();
  if (widest_m < 0) return std::nullopt;
  return 2 * static_cast<double>(widest_m);
}

}  // namespace graspd::perception
