#include "pick_point_images.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graspd/types/request.hpp"
#include "symmetry_group.hpp"

namespace graspd::parts {
namespace {

using std::numbers::pi;
constexpr int kTurns = 24;
constexpr double kSamePlace_m = 5e-4;
const double kSameDirection = std::cos(0.03);

Eigen::Isometry3d turn_of(const ContinuousSymmetry& symmetry, double angle_rad) {
  return Eigen::Translation3d(symmetry.point_m) * Eigen::AngleAxisd(angle_rad, symmetry.axis) *
         Eigen::Translation3d(-symmetry.point_m);
}

std::vector<Eigen::Isometry3d> icosahedral_turns(const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d corner = Eigen::Vector3d(0, 1, std::numbers::phi).normalized();
  return close_group({turn_of({corner, centre_m}, 2 * pi / 5),
                      turn_of({Eigen::Vector3d::UnitZ(), centre_m}, pi)})
      .value();
}

std::vector<Eigen::Isometry3d> continuous_turns(const Symmetries& symmetries) {
  std::vector<Eigen::Isometry3d> turns{Eigen::Isometry3d::Identity()};
  if (symmetries.continuous.size() > 1) {
    const auto others = icosahedral_turns(symmetries.continuous.front().point_m);
    turns.insert(turns.end(), others.begin(), others.end());
  } else if (!symmetries.continuous.empty()) {
    for (int k = 1; k < kTurns; ++k) {
      turns.push_back(turn_of(symmetries.continuous.front(), 2 * pi * k / kTurns));
    }
  }
  return turns;
}

bool is_same_direction(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.dot(b) > kSameDirection;
}

}  // namespace

std::vector<Eigen::Isometry3d> turns_of(const Symmetries& symmetries) {
  std::vector<Eigen::Isometry3d> turns = continuous_turns(symmetries);
  const std::size_t continuous_n = turns.size();
  for (const Eigen::Isometry3d& T : symmetries.discrete) {
    for (std::size_t i = 0; i < continuous_n; ++i) turns.push_back(turns[i] * T);
  }
  return turns;
}

bool is_same_grasp(const PickPoint& a, const PickPoint& b) {
  if ((a.position_m - b.position_m).norm() > kSamePlace_m) return false;
  const bool any_approach = a.approach_cone_rad >= pi && b.approach_cone_rad >= pi;
  if (!any_approach && !is_same_direction(a.approach, b.approach)) return false;
  const auto is_cup = [](const PickPoint& p) {
    return p.gripper == name_of(GripperKind::kSuction);
  };
  if (is_cup(a) != is_cup(b)) return false;
  return is_cup(a) || std::abs(a.closing.dot(b.closing)) > kSameDirection;
}

std::vector<PickPoint> images_of(const PickPoint& point,
                                 const std::vector<Eigen::Isometry3d>& turns) {
  std::vector<PickPoint> images;
  for (const Eigen::Isometry3d& T : turns) {
    PickPoint image = point;
    image.position_m = T * point.position_m;
    image.approach = T.linear() * point.approach;
    image.closing = T.linear() * point.closing;
    const bool is_known = std::any_of(images.begin(), images.end(), [&](const PickPoint& known) {
      return is_same_grasp(known, image);
    });
    if (!is_known) images.push_back(std::move(image));
  }
  return images;
}

}  // namespace graspd::parts
