/// The way of a part's candidates through the checks, with openings worked out by hand.
#include "graspd/perception/grasp_planning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "block_pile.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using testing::bar_at;
using ::testing::HasSubstr;

CheckReport report_of(const PlannedGrasp& grasp, Check check) {
  for (const auto& report : grasp.checks) {
    if (report.check == check) return report;
  }
  ADD_FAILURE() << "no report of " << name_of(check);
  return {};
}

class PlanGrasps : public ::testing::Test {
 protected:
  /// Without an image, where `scene_` has none.
  PartGrasps plan(const std::vector<PlacedPart>& parts) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < parts.size(); ++i) ids.push_back(i + 1);
    CollisionScene collision(scene_, parts, bin_, gripper_, collision_);
    return plan_grasps_of(0, parts, ids, gripper_, parameters_, collision,
                          /*explain_rejected=*/true);
  }

  Scene scene_;
  std::optional<Bin> bin_;
  Gripper gripper_;
  GraspParameters parameters_;
  CollisionParameters collision_;
};

TEST_F(PlanGrasps, ClosesAcrossTheAxisAndComesFromAbove) {
  for (const double yaw : {0.0, 0.4, 1.3, 2.9}) {
    const std::vector<PlacedPart> parts = {bar_at({0, 0, 0.02}, yaw)};
    const PartGrasps grasps = plan(parts);
    ASSERT_EQ(grasps.free.size(), 3U);
    EXPECT_FALSE(grasps.rejected);
    const PlannedGrasp& grasp = grasps.free.front();
    const Eigen::Matrix3d R = grasp.T_floor_grasp.linear();
    EXPECT_TRUE(R.col(2).isApprox(-Vector3d::UnitZ(), 1e-9)) << "approach from above";
    EXPECT_NEAR(R.col(0).dot(parts[0].principal_axis()), 0, 1e-9) << "closing across the axis";
    EXPECT_NEAR(R.determinant(), 1, 1e-9);
    // The bar's width is 20 mm; 5 mm of clearance on each side.
    EXPECT_NEAR(grasp.opening_width_m, 0.030, 1e-6);
    EXPECT_EQ(report_of(grasp, Check::kOpening).state, CheckState::kPassed);
    EXPECT_EQ(report_of(grasp, Check::kGripperParts).state, CheckState::kPassed);
    EXPECT_EQ(report_of(grasp, Check::kHeldPart).state, CheckState::kPassed);
    EXPECT_EQ(report_of(grasp, Check::kGripperBin).state, CheckState::kNotRun);
    EXPECT_EQ(report_of(grasp, Check::kGripperBin).reason, "no bin was given");
    EXPECT_EQ(report_of(grasp, Check::kGripperCloud).state, CheckState::kNotRun);
  }
}

TEST_F(PlanGrasps, APartThatStandsIsGraspedAcrossItsSecondAxis) {
  // Upright, the bar shows 20 mm along y and 10 mm along x: the jaws take the 10 mm.
  const PartGrasps grasps = plan({bar_at({0, 0, 0.04}, 0, M_PI / 2)});
  ASSERT_FALSE(grasps.free.empty());
  EXPECT_NEAR(grasps.free.front().opening_width_m, 0.020, 1e-6);
}

TEST_F(PlanGrasps, SaysWhenTheGripperIsTooNarrow) {
  gripper_.max_opening_m = 0.023;  // 20 mm of part, and 2 mm on each side at the least
  const PartGrasps grasps = plan({bar_at({0, 0, 0.02})});
  EXPECT_TRUE(grasps.free.empty());
  ASSERT_TRUE(grasps.rejected);
  EXPECT_NEAR(grasps.rejected->opening_width_m, 0.023, 1e-9) << "clamped to the stroke";
  const CheckReport opening = report_of(*grasps.rejected, Check::kOpening);
  EXPECT_EQ(opening.state, CheckState::kFailed);
  EXPECT_THAT(opening.reason, HasSubstr("20.0 mm wide here and needs 24.0 mm"));
  EXPECT_GT(grasps.rejected_by_check_n[0], 0U);
}

TEST_F(PlanGrasps, AStrokeThatIsShortOfTheWholeClearanceIsUsed) {
  gripper_.max_opening_m = 0.025;
  const PartGrasps grasps = plan({bar_at({0, 0, 0.02})});
  ASSERT_FALSE(grasps.free.empty());
  EXPECT_NEAR(grasps.free.front().opening_width_m, 0.025, 1e-9);
}

TEST_F(PlanGrasps, SaysWhenTheGripperDoesNotCloseFarEnough) {
  gripper_.min_opening_m = 0.05;
  const PartGrasps grasps = plan({bar_at({0, 0, 0.02})});
  ASSERT_TRUE(grasps.rejected);
  EXPECT_THAT(report_of(*grasps.rejected, Check::kOpening).reason, HasSubstr("closes to 50.0 mm"));
}

TEST_F(PlanGrasps, OpensLessWhereANeighbourIsNear) {
  // Of the gap, a jaw takes 8 mm and its margin 2 mm: 5 mm of clearance do not fit, 2 mm do.
  for (const double gap_m : {0.030, 0.0125}) {
    const double aside_m = 0.02 + gap_m;
    const PartGrasps grasps =
        plan({bar_at({0, 0, 0.02}), bar_at({0, aside_m, 0.02}), bar_at({0, -aside_m, 0.02})});
    ASSERT_FALSE(grasps.free.empty()) << gap_m;
    EXPECT_NEAR(grasps.free.front().opening_width_m, gap_m < 0.014 ? 0.024 : 0.030, 1e-6);
  }
  const PartGrasps none =
      plan({bar_at({0, 0, 0.02}), bar_at({0, 0.03, 0.02}), bar_at({0, -0.03, 0.02})});
  EXPECT_TRUE(none.free.empty()) << "10 mm are too few";
  ASSERT_TRUE(none.rejected);
  EXPECT_THAT(report_of(*none.rejected, Check::kGripperParts).reason,
              HasSubstr("the jaw cuts into object "));
}

TEST_F(PlanGrasps, TiltsAwayFromAWall) {
  bin_ = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.3, 0.2, 0.1), 0.005};
  parameters_.tries_per_part_n = 100;
  // 28 mm from the wall at x = +0.15: the palm, 50 mm to each side, does not fit straight down.
  const PartGrasps grasps = plan({bar_at({0.122, 0, 0.03}, M_PI / 2)});
  ASSERT_FALSE(grasps.free.empty());
  const Vector3d approach = grasps.free.front().T_floor_grasp.linear().col(2);
  EXPECT_LT(approach.z(), -0.8) << "as near to vertical as the bin allows";
  EXPECT_GT(approach.x(), 0.05) << "from the middle towards the wall";
  EXPECT_GT(grasps.rejected_by_check_n[static_cast<std::size_t>(Check::kGripperBin)], 0U);
}

TEST_F(PlanGrasps, InTheMiddleOfTheBinDoesNotTilt) {
  bin_ = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.3, 0.2, 0.1), 0.005};
  const PartGrasps grasps = plan({bar_at({0, 0, 0.03})});
  ASSERT_FALSE(grasps.free.empty());
  const Vector3d approach = grasps.free.front().T_floor_grasp.linear().col(2);
  EXPECT_TRUE(approach.isApprox(-Vector3d::UnitZ(), 1e-9));
}

TEST_F(PlanGrasps, StopsAtEnoughFreeOnes) {
  for (const int wanted_n : {1, 5}) {
    parameters_.grasps_per_part_n = wanted_n;
    EXPECT_EQ(plan({bar_at({0, 0, 0.02})}).free.size(), static_cast<std::size_t>(wanted_n));
  }
  parameters_.tries_per_part_n = 2;
  EXPECT_EQ(plan({bar_at({0, 0, 0.02})}).free.size(), 2U) << "and at enough tries";
}

TEST_F(PlanGrasps, LooksOnWhereThePreferredOnesHaveLittleRoom) {
  parts::Part part = testing::bar();
  for (const double x_m : {-0.012, -0.006, 0.0, 0.028}) {  // the preferred first
    parts::PickPoint& point = part.pick_points.emplace_back();
    point.position_m.x() = x_m;
    point.closing = Vector3d::UnitY();
    point.width_m = 0.02;
    point.priority = -x_m;
  }
  // Two bars end 16 mm beside the first: at the middle jaw, clearance and margin just fit.
  std::vector<PlacedPart> parts = {bar_at({0, 0, 0.02}), bar_at({-0.012, 0.066, 0.02}, M_PI / 2),
                                   bar_at({-0.012, -0.066, 0.02}, M_PI / 2)};
  parts[0].part = &part;
  const PartGrasps grasps = plan(parts);
  ASSERT_EQ(grasps.free.size(), 3U);
  EXPECT_LT(grasps.free.front().room_m, CollisionScene::kAllRoom_m) << "the preferred stays first";
  EXPECT_EQ(grasps.free.back().room_m, CollisionScene::kAllRoom_m);
  EXPECT_NEAR(grasps.free.back().T_floor_grasp.translation().x(), 0.028, 1e-9);
}

TEST_F(PlanGrasps, ABuriedPartIsRejectedWithWhatLiesOnIt) {
  const PartGrasps grasps = plan({bar_at({0, 0, 0.005}), bar_at({0, 0, 0.016}, M_PI / 2)});
  EXPECT_TRUE(grasps.free.empty());
  ASSERT_TRUE(grasps.rejected);
  EXPECT_EQ(report_of(*grasps.rejected, Check::kHeldPart).reason,
            "lifted straight up, the part takes object 2 with it");
}

TEST_F(PlanGrasps, EveryFreeGraspHasPassedEveryCheckThatRan) {
  testing::BlockPile pile;
  for (int i = 0; i < 9; ++i) {
    const int row = i / 3;
    pile.parts.push_back(bar_at({0.12 * (i % 3) - 0.12, 0.09 * row - 0.09, 0.006}, 0.4 * i));
  }
  pile.look();
  scene_ = pile.scene;
  bin_ = pile.bin;
  std::size_t free_n = 0;
  for (std::size_t first = 0; first < pile.parts.size(); ++first) {
    std::swap(pile.parts[0], pile.parts[first]);
    const PartGrasps grasps = plan(pile.parts);
    EXPECT_NE(grasps.free.empty(), !grasps.rejected.has_value());
    for (const PlannedGrasp& grasp : grasps.free) {
      ++free_n;
      for (const CheckReport& check : grasp.checks) {
        EXPECT_EQ(check.state, CheckState::kPassed) << name_of(check.check);
        EXPECT_EQ(check.reason, "");
      }
    }
    if (!grasps.rejected) continue;
    EXPECT_TRUE(std::any_of(grasps.rejected->checks.begin(), grasps.rejected->checks.end(),
                            [](const auto& check) {
                              return check.state == CheckState::kFailed && !check.reason.empty();
                            }));
  }
  EXPECT_GT(free_n, 9U);
}

}  // namespace
}  // namespace graspd::perception
