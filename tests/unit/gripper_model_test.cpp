/// Boxes of a gripper on its way, and whether two boxes share a volume.
#include "graspd/perception/gripper_model.hpp"

#include <gtest/gtest.h>

#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

TEST(SweptGripper, JawsStandBesideTheOpeningAndReachBackByTheStandoff) {
  const Gripper gripper;
  const SweptGripper swept(gripper, 0.03);
  ASSERT_EQ(swept.boxes().size(), 3U);
  const auto& [name, left_m, moves] = swept.boxes()[1];
  EXPECT_EQ(name, "jaw");
  EXPECT_TRUE(moves);
  EXPECT_TRUE(left_m.min().isApprox(Vector3d(-0.023, -0.008, -0.125)));
  EXPECT_TRUE(left_m.max().isApprox(Vector3d(-0.015, 0.008, 0)));
  EXPECT_TRUE(swept.boxes()[2].box_m.min().isApprox(Vector3d(0.015, -0.008, -0.125)));
  const Eigen::AlignedBox3d& palm_m = swept.boxes()[0].box_m;
  EXPECT_TRUE(palm_m.min().isApprox(Vector3d(-0.05, -0.03, -0.185)));
  EXPECT_TRUE(palm_m.max().isApprox(Vector3d(0.05, 0.03, -0.045)));
}

TEST(SweptGripper, HoldsTheGripperAtEveryPointOfItsWay) {
  Gripper standing;
  standing.standoff_m = 0;
  const Gripper gripper;
  for (const double opening_m : {0.0, 0.02, 0.08}) {
    const SweptGripper at_rest(standing, opening_m);
    const SweptGripper swept(gripper, opening_m);
    for (const double back_m : {0.0, 0.01, 0.04, gripper.standoff_m}) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::AlignedBox3d box_m =
            at_rest.boxes()[i].box_m.translated(Vector3d(0, 0, -back_m));
        EXPECT_TRUE(swept.boxes()[i].box_m.contains(box_m));
      }
    }
  }
}

TEST(SweptGripper, ASuctionCupIsABoxAroundIt) {
  Gripper gripper;
  gripper.kind = GripperKind::kSuction;
  gripper.cup_diameter_m = 0.02;
  const SweptGripper swept(gripper, 0);
  ASSERT_EQ(swept.boxes().size(), 2U);
  EXPECT_EQ(swept.boxes()[1].name, "cup");
  EXPECT_TRUE(swept.boxes()[1].box_m.sizes().isApprox(Vector3d(0.02, 0.02, 0.125)));
  EXPECT_DOUBLE_EQ(swept.boxes()[1].box_m.max().z(), 0);
}

/// A point that is in both boxes, by alternating projections; they converge where there is one.
bool share_a_point(const OrientedBox& a, const OrientedBox& b) {
  const auto nearest_in = [](const OrientedBox& box, const Vector3d& p) -> Vector3d {
    const Vector3d local = box.axes.transpose() * (p - box.centre_m);
    return box.centre_m + box.axes * local.cwiseMax(-box.half_m).cwiseMin(box.half_m);
  };
  Vector3d p = a.centre_m;
  for (int i = 0; i < 2000; ++i) p = nearest_in(a, nearest_in(b, p));
  return (p - nearest_in(b, p)).norm() < 1e-6;
}

TEST(Overlap, AgreesWithASearchForASharedPoint) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> size(0.01, 1.0);
  int overlaps_n = 0;
  for (int i = 0; i < 400; ++i) {
    OrientedBox boxes[2];
    for (OrientedBox& box : boxes) {
      const Eigen::Isometry3d T = testing::random_pose(random, 1.2);
      box.centre_m = T.translation();
      box.axes = T.linear();
      box.half_m = Vector3d(size(random), size(random), size(random)) / 2;
    }
    const bool expected = share_a_point(boxes[0], boxes[1]);
    overlaps_n += expected;
    EXPECT_EQ(overlap(boxes[0], boxes[1]), expected) << "pair " << i;
    EXPECT_EQ(overlap(boxes[1], boxes[0]), expected) << "pair " << i;
  }
  EXPECT_GT(overlaps_n, 50);
  EXPECT_LT(overlaps_n, 350);
}

TEST(Overlap, TouchingIsNone) {
  OrientedBox a, b;
  a.half_m = b.half_m = Vector3d::Constant(0.5);
  b.centre_m.x() = 1;
  EXPECT_FALSE(overlap(a, b));
  b.centre_m.x() = 0.999;
  EXPECT_TRUE(overlap(a, b));
  b.half_m.x() = 0;
  b.centre_m.x() = 0.4;
  EXPECT_TRUE(overlap(a, b)) << "a wall of no thickness is still in the way";
}

}  // namespace
}  // namespace graspd::perception
