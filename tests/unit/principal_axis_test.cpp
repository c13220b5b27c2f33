#include "graspd/perception/principal_axis.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "block_pile.hpp"
#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using testing::bar;
using testing::bar_at;

TEST(GraspPoint, AloneIsTheBarycentre) {
  const std::vector<PlacedPart> parts = {bar_at({0.1, 0.2, 0.005})};
  EXPECT_TRUE(grasp_point(0, parts, {}).isApprox(Vector3d(0.1, 0.2, 0.005)));
}

TEST(GraspPoint, WithoutTheNeighbourTermIsTheBarycentre) {
  const std::vector<PlacedPart> parts = {bar_at({0, 0, 0.005}), bar_at({0, 0.03, 0.005})};
  GraspParameters parameters;
  parameters.k4 = 0;
  EXPECT_TRUE(grasp_point(0, parts, parameters).isApprox(Vector3d(0, 0, 0.005), 1e-9));
}

TEST(GraspPoint, MinimisesTheWeightedSumOfBothDistances) {
  // The neighbour stands across at x = 0.08: its nearest points are at x = 0.07. On the axis at x,
  // dn(x) = 0.07 − x and de(x) = |x|. With k3 = 1, k4 = −2 the sum is |x| − 2·(0.07 − x): for
  // x < 0 it is x − 0.14, least at the far end. The bar ends at −0.04; the last step on it may be
  // one step before.
  const std::vector<PlacedPart> parts = {bar_at({0, 0, 0.005}), bar_at({0.08, 0, 0.005}, M_PI / 2)};
  GraspParameters parameters;
  parameters.k3 = 1;
  parameters.k4 = -2;
  const double far_end_m = grasp_point(0, parts, parameters).x();
  EXPECT_GE(far_end_m, -0.04 - 1e-6);
  EXPECT_LE(far_end_m, -0.04 + parameters.axis_step_m + 1e-6);
  // With k4 = −0.5 the sum is −x/2 − 0.035 for x < 0, which grows away from 0: the barycentre.
  parameters.k4 = -0.5;
  EXPECT_NEAR(grasp_point(0, parts, parameters).x(), 0, 1e-6);
}

TEST(GraspPoint, StaysAtTheBarycentreWhereTheNeighbourWeighsNoMoreThanTheDistance) {
  // The shortcut for |k4| ≤ k3 against the search, which just more than k3 starts.
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    std::vector<PlacedPart> parts;
    for (int k = 0; k < 5; ++k) {
      parts.push_back(bar_at(testing::random_point(random, 0.12F).cast<double>(), 0.5 * k));
    }
    GraspParameters searched;
    searched.k3 = 1 - 1e-4;
    searched.k4 = i % 2 == 0 ? -1 : 1;
    GraspParameters shortcut = searched;
    shortcut.k3 = 1;
    const auto cost = [&](const GraspParameters& p) {
      const Vector3d x_m = grasp_point(0, parts, p);
      double dn2_m2 = std::numeric_limits<double>::max();
      for (std::size_t other = 1; other < parts.size(); ++other) {
        for (const auto& point : bar().surface) {
          const Vector3d q_m = parts[other].T_floor_part * point.position_m.cast<double>();
          dn2_m2 = std::min(dn2_m2, (q_m - x_m).squaredNorm());
        }
      }
      return (x_m - parts[0].barycentre_m()).norm() + searched.k4 * std::sqrt(dn2_m2);
    };
    EXPECT_LE(cost(shortcut), cost(searched) + 1e-5);
  }
}

}  // namespace
}  // namespace graspd::perception
