#include "graspd/agent/stir.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace graspd::agent {
namespace {

constexpr double kCell_m = 0.02;
/// Fewer readings are no surface.
constexpr std::size_t kMinReadings_n = 5;
constexpr double kClearance_m = 0.01;
constexpr double kShortest_m = 0.02;

/// Where the pile is highest: the cell of a coarse height map whose readings reach up most, by
/// their 90th percentile, which a flying pixel does not move.
std::optional<Eigen::Vector3d> top_of_pile(const Surroundings& surroundings) {
  const Eigen::Isometry3d T_bin_base = surroundings.bin->T_base_bin.inverse();
  const Eigen::Vector2d half_m = surroundings.bin->inner_size_m.head<2>() / 2;
  std::map<std::pair<int, int>, std::vector<double>> heights_m;
  for (const Eigen::Vector3f& p_base_m : surroundings.p_base_m) {
    const Eigen::Vector3d p_bin_m = T_bin_base * p_base_m.cast<double>();
    // The walls are no pile.
    if ((p_bin_m.head<2>().array().abs() > half_m.array() - kClearance_m).any()) continue;
    const Eigen::Vector2i cell = (p_bin_m.head<2>() / kCell_m).array().floor().cast<int>();
    heights_m[{cell.x(), cell.y()}].push_back(p_bin_m.z());
  }
  std::optional<Eigen::Vector3d> top_m;
  for (auto& [cell, z_m] : heights_m) {
    if (z_m.size() < kMinReadings_n) continue;
    const auto ninth = z_m.begin() + static_cast<std::ptrdiff_t>(z_m.size() * 9 / 10);
    std::nth_element(z_m.begin(), ninth, z_m.end());
    if (top_m && *ninth <= top_m->z()) continue;
    top_m = {(cell.first + 0.5) * kCell_m, (cell.second + 0.5) * kCell_m, *ninth};
  }
  return top_m;
}

/// How far the gripper reaches from the grasp frame with its jaws closed, along the bin's x: what
/// of it is below the rim, whose height is given above the tips.
Eigen::Vector2d reach_m(const graspd::Gripper& gripper, double rim_m) {
  Eigen::Vector2d reach_m(gripper.jaw_size_m.x(), gripper.jaw_size_m.y() / 2);
  const bool is_palm_below_rim = gripper.jaw_size_m.z() < rim_m + kClearance_m;
  if (is_palm_below_rim) reach_m = reach_m.cwiseMax(gripper.palm_size_m.head<2>() / 2);
  return reach_m;
}

/// Whether something lies where closed jaws come down. A hollow part that they come down into hangs
/// on them, and no sensor of a gripper tells.
bool is_below(const Surroundings& surroundings, const graspd::Gripper& gripper,
              const Eigen::Isometry3d& T_base_tips) {
  const Eigen::Isometry3f T_tips_base = T_base_tips.inverse().cast<float>();
  const Eigen::Array2f half_m =
      Eigen::Array2d(gripper.jaw_size_m.x(), gripper.jaw_size_m.y() / 2).cast<float>() +
      static_cast<float>(kClearance_m);
  std::size_t readings_n = 0;
  for (const Eigen::Vector3f& p_base_m : surroundings.p_base_m) {
    const Eigen::Vector3f p_m = T_tips_base * p_base_m;
    readings_n += p_m.z() < 0 && (p_m.head<2>().array().abs() < half_m).all();
  }
  return readings_n >= kMinReadings_n;
}

Stroke stroke_between(const Eigen::Isometry3d& T_base_bin, const Eigen::Vector3d& from_m,
                      const Eigen::Vector3d& to_m, double up_z_m, double speed_share) {
  const auto pose = [&](const Eigen::Vector3d& p_bin_m) {
    Eigen::Isometry3d T_bin_grasp = Eigen::Isometry3d::Identity();
    T_bin_grasp.translation() = p_bin_m;
    T_bin_grasp.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();  // z down
    return Eigen::Isometry3d(T_base_bin * T_bin_grasp);
  };
  const Eigen::Vector3d up_m(0, 0, up_z_m - from_m.z());
  return {{{Step::kStirAbove, Path::kFree, pose(from_m + up_m)},
           {Step::kStirDown, Path::kStraight, pose(from_m), speed_share},
           {Step::kStirAcross, Path::kStraight, pose(to_m), speed_share},
           {Step::kStirUp, Path::kStraight, pose(to_m + up_m)}}};
}

}  // namespace

std::vector<Stroke> strokes(const Surroundings& surroundings, const graspd::Gripper& gripper,
                            const StirOptions& options) {
  if (!surroundings.bin) return {};
  const auto top_m = top_of_pile(surroundings);
  if (!top_m) return {};
  const double z_m = std::max(top_m->z() - options.depth_m, kClearance_m);
  const Eigen::Vector2d room_m = surroundings.bin->inner_size_m.head<2>() / 2 -
                                 reach_m(gripper, surroundings.bin->inner_size_m.z() - z_m) -
                                 Eigen::Vector2d::Constant(kClearance_m);
  if (room_m.minCoeff() < 0) return {};

  // Empty jaws need no more than to clear the rim, and higher up an arm reaches less far.
  const double up_z_m =
      std::min(z_m + gripper.retreat_m,
               std::max(top_m->z(), surroundings.bin->inner_size_m.z()) + kClearance_m);
  std::vector<Stroke> strokes;
  for (const int axis : {0, 1}) {
    Eigen::Vector3d middle_m(0, 0, z_m);
    middle_m.head<2>() = top_m->head<2>().cwiseMax(-room_m).cwiseMin(room_m);
    Eigen::Vector3d from_m = middle_m;
    Eigen::Vector3d to_m = middle_m;
    from_m[axis] = std::max(middle_m[axis] - options.stroke_m / 2, -room_m[axis]);
    to_m[axis] = std::min(middle_m[axis] + options.stroke_m / 2, room_m[axis]);
    if (to_m[axis] - from_m[axis] < kShortest_m) continue;
    for (int way = 0; way < 2; ++way) {
      strokes.push_back(
          stroke_between(surroundings.bin->T_base_bin, from_m, to_m, up_z_m, options.speed_share));
      std::swap(from_m, to_m);
    }
  }
  std::ranges::stable_partition(strokes, [&](const Stroke& stroke) {
    return !is_below(surroundings, gripper, stroke[1].T_base_grasp);
  });
  return strokes;
}

}  // namespace graspd::agent
