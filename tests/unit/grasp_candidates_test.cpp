/// Grasp position (the paper, III-D.2) with numbers worked out by hand.
#include "graspd/perception/grasp_candidates.hpp"

#include <gtest/gtest.h>

#include "block_scene.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

const parts::Part& bar() {
  static const parts::Part part = testing::block_part("bar", {0.080, 0.020, 0.010});
  return part;
}

PlacedPart at(const Vector3d& p_m, double yaw_rad = 0) {
  PlacedPart placed{&bar(), Eigen::Isometry3d::Identity()};
  placed.T_floor_part.translate(p_m);
  placed.T_floor_part.rotate(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()));
  return placed;
}

TEST(GraspPoint, AloneIsTheBarycentre) {
  const std::vector<PlacedPart> parts = {at({0.1, 0.2, 0.005})};
  EXPECT_TRUE(grasp_point(0, parts, {}).isApprox(Vector3d(0.1, 0.2, 0.005)));
}

TEST(GraspPoint, WithoutTheNeighbourTermIsTheBarycentre) {
  const std::vector<PlacedPart> parts = {at({0, 0, 0.005}), at({0, 0.03, 0.005})};
  GraspParameters parameters;
  parameters.k4 = 0;
  EXPECT_TRUE(grasp_point(0, parts, parameters).isApprox(Vector3d(0, 0, 0.005), 1e-9));
}

TEST(GraspPoint, MinimisesTheWeightedSumOfBothDistances) {
  // The neighbour stands across at x = 0.08: its nearest points are at x = 0.07. On the axis at x,
  // dn(x) = 0.07 − x and de(x) = |x|. With k3 = 1, k4 = −2 the sum is |x| − 2·(0.07 − x): for
  // x < 0 it is x − 0.14, least at the far end. The bar ends at −0.04; the last step on it may be
  // one step before.
  const std::vector<PlacedPart> parts = {at({0, 0, 0.005}), at({0.08, 0, 0.005}, M_PI / 2)};
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

TEST(GraspCandidates, AreAtThePointFromTheVerticalOutwards) {
  const std::vector<PlacedPart> parts = {at({0, 0, 0.02}, 0.7)};
  const auto candidates = grasp_candidates(0, parts, Gripper{}, {});
  ASSERT_GT(candidates.size(), 8U);
  EXPECT_TRUE(candidates.front().T_floor_grasp.linear().col(2).isApprox(-Vector3d::UnitZ(), 1e-9));
  EXPECT_NEAR(candidates.front().width_m, 0.020, 1e-6);
  double last = 1;
  for (const GraspCandidate& candidate : candidates) {
    EXPECT_TRUE(candidate.T_floor_grasp.translation().isApprox(Vector3d(0, 0, 0.02), 1e-9));
    EXPECT_LE(candidate.preference, last + 1e-9);
    last = candidate.preference;
  }
}

}  // namespace
}  // namespace graspd::perception
