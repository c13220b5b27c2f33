#include "approach_sectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "graspd/types/request.hpp"

namespace graspd::parts {
namespace {

constexpr std::size_t kDirections = 24;
constexpr double kStep_rad = 2 * std::numbers::pi / kDirections;
constexpr std::size_t kMinDirections = 3;  // side by side: a pose is never quite as it was found
constexpr double kTouch_m = 0.0005;  // a point of the surface so near to a closed jaw is held by it

/// Whether each direction is free, counter-clockwise about the closing direction.
using Free = std::array<bool, kDirections>;

struct Direction {
  double cosine, sine;
};

const std::array<Direction, kDirections>& directions() {
  static const std::array<Direction, kDirections> all = [] {
    std::array<Direction, kDirections> made{};
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double angle_rad = static_cast<double>(k) * kStep_rad;
      made[k] = {std::cos(angle_rad), std::sin(angle_rad)};
    }
    return made;
  }();
  return all;
}

/// What a gripper sweeps, in the plane across the closing direction: all behind its front.
struct Sweep {
  double front_m, half_width_m;

  bool holds(double along_m, double aside_m) const {
    return along_m <= front_m && std::abs(aside_m) <= half_width_m;
  }
};

Free free_directions(const AntipodalPair& pair, double tip_reach_m,
                     const std::vector<SurfacePoint>& surface, const Eigen::Vector3d& u) {
  const Gripper gripper;
  const Sweep jaws{tip_reach_m, gripper.jaw_size_m.y() / 2};
  const Sweep palm{tip_reach_m - gripper.jaw_size_m.z(), gripper.palm_size_m.y() / 2};
  const double inner_m = pair.width_m / 2 + kTouch_m;
  const double outer_m = pair.width_m / 2 + gripper.clearance_m + gripper.jaw_size_m.x();
  const Eigen::Vector3d v = pair.closing.cross(u);
  Free free;
  free.fill(true);
  for (const SurfacePoint& point : surface) {
    const Eigen::Vector3d d_m = point.position_m.cast<double>() - pair.middle_m;
    const double across_m = std::abs(pair.closing.dot(d_m));
    const bool beside_jaw = across_m >= inner_m && across_m <= outer_m;
    const bool below_palm = across_m <= gripper.palm_size_m.x() / 2;
    if (!beside_jaw && !below_palm) continue;
    const double on_u_m = u.dot(d_m);
    const double on_v_m = v.dot(d_m);
    for (std::size_t k = 0; k < kDirections; ++k) {
      const auto [cosine, sine] = directions()[k];
      const double along_m = cosine * on_u_m + sine * on_v_m;
      const double aside_m = cosine * on_v_m - sine * on_u_m;
      const bool is_met = (beside_jaw && jaws.holds(along_m, aside_m)) ||
                          (below_palm && palm.holds(along_m, aside_m));
      free[k] = free[k] && !is_met;
    }
  }
  return free;
}

}  // namespace

std::vector<ApproachSector> approach_sectors(const AntipodalPair& pair, double tip_reach_m,
                                             const std::vector<SurfacePoint>& surface) {
  const Eigen::Vector3d u = pair.closing.unitOrthogonal();
  const Free free = free_directions(pair, tip_reach_m, surface, u);
  const auto approach_at = [&](double angle_rad) -> Eigen::Vector3d {
    return std::cos(angle_rad) * u + std::sin(angle_rad) * pair.closing.cross(u);
  };
  const auto blocked = std::find(free.begin(), free.end(), false);
  if (blocked == free.end()) return {{u, std::numbers::pi}};

  // Once round, from a blocked direction to itself.
  std::vector<ApproachSector> sectors;
  const auto first = static_cast<std::size_t>(blocked - free.begin());
  std::size_t free_n = 0;
  for (std::size_t k = first + 1; k <= first + kDirections; ++k) {
    if (free[k % kDirections]) {
      ++free_n;
      continue;
    }
    if (free_n >= kMinDirections) {
      const double half_rad = static_cast<double>(free_n - 1) * kStep_rad / 2;
      const double middle_rad = static_cast<double>(k - 1) * kStep_rad - half_rad;
      sectors.push_back({approach_at(middle_rad), half_rad});
    }
    free_n = 0;
  }
  std::stable_sort(sectors.begin(), sectors.end(),
                   [](const auto& a, const auto& b) { return a.cone_rad > b.cone_rad; });
  return sectors;
}

}  // namespace graspd::parts
