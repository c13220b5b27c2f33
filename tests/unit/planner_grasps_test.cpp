#include <gmock/gmock.h>

#include <algorithm>

#include "planner_fixture.hpp"

// The grasps of whole plans: which checks they pass, their order, cups.

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

TEST_F(Planner, ATooNarrowGripperIsAllInCollisionWithTheReason) {
  request_.gripper.max_opening_m = 0.02;
  request_.options.explain_rejected = true;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(answer->reason, HasSubstr("opening: the part is"));
  EXPECT_EQ(answer->rejected_grasps.size(), answer->objects.size());
  EXPECT_GE(answer->funnel.rejected_by_check_n[0], answer->objects.size());
}

TEST_F(Planner, EveryGraspSaysWhichChecksRan) {
  const DepthFrame frame = frame_of(pile(6));
  for (const bool is_on : {true, false}) {
    parameters_.collision.gripper_cloud = is_on;
    const auto answer = plan_of(frame);
    ASSERT_TRUE(answer);
    ASSERT_FALSE(answer->grasps.empty());
    std::map<std::uint32_t, int> grasps_n;
    for (const Grasp& grasp : answer->grasps) {
      ++grasps_n[grasp.object_id];
      ASSERT_EQ(grasp.checks.size(), std::size(EnumNames<Check>::values));
      for (const CheckReport& check : grasp.checks) {
        const bool is_off = check.check == Check::kGripperCloud && !is_on;
        EXPECT_EQ(check.state, is_off ? CheckState::kNotRun : CheckState::kPassed)
            << name_of(check.check) << ": " << check.reason;
      }
    }
    for (const auto& [id, count_n] : grasps_n) {
      EXPECT_LE(count_n, parameters_.grasp.grasps_per_part_n) << "object " << id;
    }
  }
}

TEST_F(Planner, ThePapersPreprocessingIsCheckedAgainstTheImageToo) {
  parameters_.segmentation.method = Segmentation::kImprovedDbscan;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  ASSERT_FALSE(answer->grasps.empty());
  for (const CheckReport& check : answer->grasps.front().checks) {
    EXPECT_EQ(check.state, CheckState::kPassed) << name_of(check.check) << ": " << check.reason;
  }
}

TEST_F(Planner, AGripperWiderThanTheBinIsAllInCollisionWithTheReason) {
  request_.gripper.palm_size_m = Vector3d(0.5, 0.5, 0.3);
  request_.options.explain_rejected = true;
  const auto answer = plan_of(frame_of(pile(3)));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(answer->reason, HasSubstr("gripper_bin: "));
  EXPECT_FALSE(answer->rejected_grasps.empty());
  EXPECT_GE(answer->funnel.rejected_by_check_n[static_cast<std::size_t>(Check::kGripperBin)],
            answer->objects.size());
}

TEST_F(Planner, AFailedSpotIsRankedLast) {
  const DepthFrame frame = frame_of(pile(6));
  const auto first = plan_of(frame);
  ASSERT_TRUE(first);
  ASSERT_GE(first->grasps.size(), 2U);
  FailedSpot spot;
  spot.p_base_m = first->grasps.front().T_base_grasp.translation();
  request_.failed_spots = {spot};
  const auto second = plan_of(frame);
  ASSERT_TRUE(second);
  const std::uint32_t failed_id = first->grasps.front().object_id;
  const auto next = std::ranges::find_if(
      first->grasps, [&](const Grasp& grasp) { return grasp.object_id != failed_id; });
  ASSERT_NE(next, first->grasps.end());
  EXPECT_EQ(second->grasps.back().object_id, failed_id);
  EXPECT_EQ(second->grasps.front().object_id, next->object_id);
}

TEST_F(Planner, StrategiesOrderByWhatTheySay) {
  const DepthFrame frame = frame_of(pile(6));
  request_.options.strategy = Strategy::kNearest;
  request_.options.strategy_vector_base_m = Vector3d(0.2, 0.2, 0);
  const auto answer = plan_of(frame);
  ASSERT_TRUE(answer);
  ASSERT_GE(answer->grasps.size(), 2U);
  double last_m = 0;
  for (const Grasp& grasp : first_of_each_object(answer->grasps)) {
    const double distance_m = (grasp.T_base_grasp.translation() - Vector3d(0.2, 0.2, 0)).norm();
    EXPECT_GE(distance_m, last_m);
    last_m = distance_m;
  }
}

TEST_F(Planner, ASuctionCupHoldsFlatPlacesThatFaceUp) {
  Eigen::Isometry3d T_base_block = Eigen::Isometry3d::Identity();
  T_base_block.translate(Vector3d(0.03, 0.02, kSize_m.z() / 2));
  const DepthFrame frame =
      frame_of({{testing::T_base_camera_above(kHeight_m).inverse() * T_base_block, kSize_m}});
  std::vector<parts::Part> parts;
  parts.push_back(testing::block_part("block", kSize_m));
  for (const double side : {1, -1}) {
    parts::PickPoint& face = parts[0].pick_points.emplace_back();
    face.name = "flat";
    face.position_m = Vector3d(0, 0, side * kSize_m.z() / 2);
    face.approach = Vector3d(0, 0, -side);
    face.width_m = 0.02;
    face.gripper = "suction";
  }
  const parts::Catalogue catalogue(std::move(parts));
  request_.gripper.kind = GripperKind::kSuction;
  request_.gripper.cup_diameter_m = 0.015;
  const auto answer = plan(frame, request_, catalogue, parameters_);
  ASSERT_TRUE(answer) << answer.error().message;
  ASSERT_EQ(answer->outcome, Outcome::kPlanned) << answer->reason;
  const Grasp& grasp = answer->grasps.front();
  EXPECT_EQ(grasp.pick_point, "flat");
  EXPECT_EQ(grasp.opening_width_m, 0);
  EXPECT_LT(grasp.T_base_grasp.linear().col(2).z(), -0.95) << "from above";
  EXPECT_NEAR(grasp.T_base_grasp.translation().z(), kSize_m.z(), 0.003) << "on its upper face";

  request_.gripper.cup_diameter_m = 0.2;
  const auto too_large = plan(frame, request_, catalogue, parameters_);
  ASSERT_TRUE(too_large) << too_large.error().message;
  EXPECT_EQ(too_large->outcome, Outcome::kAllInCollision);
  EXPECT_THAT(too_large->reason, HasSubstr("cup of 200.0 mm"));
}

}  // namespace
}  // namespace graspd::perception
