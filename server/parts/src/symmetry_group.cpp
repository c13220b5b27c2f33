#include "symmetry_group.hpp"

#include <algorithm>

namespace graspd::parts {
namespace {

// Loose enough that 51.43 written for 360/7 closes after 7 turns; far below the least turn of a
// group of kMaxGroupSize.
constexpr double kSameAngle_rad = 2e-3;
constexpr double kSamePlace_m = 1e-4;

bool is_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Quaterniond turn(a.linear().transpose() * b.linear());
  return turn.angularDistance(Eigen::Quaterniond::Identity()) < kSameAngle_rad &&
         (a.translation() - b.translation()).norm() < kSamePlace_m;
}

}  // namespace

Result<std::vector<Eigen::Isometry3d>> close_group(
    const std::vector<Eigen::Isometry3d>& generators) {
  std::vector<Eigen::Isometry3d> group{Eigen::Isometry3d::Identity()};
  // The list grows while it is walked: each element is multiplied with each generator once.
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const Eigen::Isometry3d& generator : generators) {
      Eigen::Isometry3d product = group[i] * generator;
      product.linear() = Eigen::Quaterniond(product.linear()).normalized().toRotationMatrix();
      const bool is_known = std::any_of(group.begin(), group.end(), [&](const auto& element) {
        return is_same(element, product);
      });
      if (is_known) continue;
      if (group.size() == kMaxGroupSize) {
        return invalid(
            "the discrete symmetries make a group of more than {} poses: write angles as 360/n, "
            "axes through one point, and a full turn as a continuous symmetry",
            kMaxGroupSize);
      }
      group.push_back(product);
    }
  }
  group.erase(group.begin());
  return group;
}

}  // namespace graspd::parts
