#include "graspd/judge/grasp_judge.hpp"

#include <gtest/gtest.h>

#include "block_scene.hpp"
#include "graspd/judge/grasp_search.hpp"

// The judge of ./run bench grasps, on scenes whose verdict is plain.
namespace graspd::judge {
namespace {

using Eigen::Translation3d;
using Eigen::Vector3d;

class Judge : public ::testing::Test {
 protected:
  static constexpr double kOnFloor_m = 0.012;  // a block's middle: 2 mm above the floor

  TruePart block_at(const Vector3d& p_m) const {
    return {&block_, Eigen::Isometry3d(Translation3d(p_m))};
  }
  GraspJudge judge_of(std::vector<TruePart> parts) const {
    return {std::move(parts), {{0.4, 0.3, 0.1}, 0.005}, gripper_};
  }
  /// Straight down, its tips so high, closing along x turned by an angle.
  static TrueGrasp grasp_at(const Vector3d& tips_m, double opening_m = 0.03, double turn_rad = 0) {
    Eigen::Isometry3d T_bin_grasp(Translation3d(tips_m) *
                                  Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()));
    T_bin_grasp.linear() = T_bin_grasp.linear() * Vector3d(1, -1, -1).asDiagonal();
    return {T_bin_grasp, opening_m, 0.08};
  }
  Judgement judgement(std::vector<TruePart> parts, const TrueGrasp& grasp) const {
    return judge_of(std::move(parts)).judge(grasp);
  }
  Finding finding(std::vector<TruePart> parts, const TrueGrasp& grasp) const {
    return judgement(std::move(parts), grasp).finding;
  }

  // Longest along y, so that jaws that close along x take it across.
  parts::Part block_ = testing::block_part("block", {0.02, 0.06, 0.02});
  Gripper gripper_;
  Vector3d on_floor_{0, 0, kOnFloor_m};
  TrueGrasp good_ = grasp_at({0, 0, 0.006});
};

TEST_F(Judge, ALoneBlockIsHeldAcross) {
  const Judgement judgement = this->judgement({block_at(on_floor_)}, good_);
  EXPECT_EQ(judgement.finding, Finding::kGood);
  EXPECT_EQ(judgement.part, 0U);
}

TEST_F(Judge, JawsMeetThePartThatIsTooWide) {
  const Judgement judgement =
      this->judgement({block_at(on_floor_)}, grasp_at({0, 0, 0.006}, 0.019));
  EXPECT_EQ(judgement.finding, Finding::kCollisionPart);
  EXPECT_EQ(judgement.part, 0U);
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0.0055, 0, 0.006})), Finding::kCollisionPart);
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0.0045, 0, 0.006})), Finding::kGood);
}

TEST_F(Judge, AJawNeedsRoomBesideThePart) {
  // The jaw is between 15 and 23 mm from the middle.
  for (const auto& [gap_m, expected] :
       {std::pair(0.0125, Finding::kCollisionPart), std::pair(0.0135, Finding::kGood)}) {
    const Judgement judgement = this->judgement(
        {block_at(on_floor_), block_at(on_floor_ + Vector3d(0.02 + gap_m, 0, 0))}, good_);
    EXPECT_EQ(judgement.finding, expected) << gap_m;
    EXPECT_EQ(judgement.part, expected == Finding::kGood ? 0U : 1U);
  }
}

TEST_F(Judge, TheWayToTheGraspCounts) {
  // Above the palm at the grasp, and below it at pre-grasp.
  const TruePart roof = block_at({0, 0.04, 0.006 + 0.045 + 0.06 + 0.05});
  EXPECT_EQ(finding({block_at(on_floor_), roof}, good_), Finding::kCollisionPart);
  TrueGrasp from_below_the_roof = good_;
  from_below_the_roof.standoff_m = 0.03;
  EXPECT_EQ(finding({block_at(on_floor_), roof}, from_below_the_roof), Finding::kGood);
}

TEST_F(Judge, FloorAndWallsAreInTheWay) {
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0, 0, -0.001})), Finding::kCollisionFloor);
  const Vector3d at_wall(0.2 - 0.0105, 0, 0);
  EXPECT_EQ(finding({block_at(on_floor_ + at_wall)}, grasp_at(at_wall + Vector3d(0, 0, 0.006))),
            Finding::kCollisionWall);
  const Vector3d off_wall = at_wall - Vector3d(0.041, 0, 0);  // half the palm is 50 mm
  EXPECT_EQ(finding({block_at(on_floor_ + off_wall)}, grasp_at(off_wall + Vector3d(0, 0, 0.006))),
            Finding::kGood);
}

TEST_F(Judge, WhatIsNotBetweenTheJawsIsNotHeld) {
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0, 0, 0.023})), Finding::kNothingBetween);
  EXPECT_EQ(finding({}, good_), Finding::kNothingBetween);
  gripper_.min_opening_m = 0.021;
  EXPECT_EQ(finding({block_at(on_floor_)}, good_), Finding::kNothingBetween);
}

TEST_F(Judge, TwoPartsBetweenTheJawsAreTwo) {
  const Vector3d beside(0.0105, 0, 0);
  EXPECT_EQ(finding({block_at(on_floor_ - beside), block_at(on_floor_ + beside)},
                    grasp_at({0, 0, 0.006}, 0.05)),
            Finding::kTwoParts);
  // One above the other.
  EXPECT_EQ(finding({block_at(on_floor_), block_at(on_floor_ + Vector3d(0, 0, 0.02))}, good_),
            Finding::kTwoParts);
}

TEST_F(Judge, SlantedFacesSlipAway) {
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0, 0, 0.006}, 0.05, 0.05)), Finding::kGood);
  EXPECT_EQ(finding({block_at(on_floor_)}, grasp_at({0, 0, 0.006}, 0.05, 0.45)),
            Finding::kNoForceClosure);
}

TEST_F(Judge, SaysTheSameOfATurnedScene) {
  const std::vector<TruePart> parts{block_at(on_floor_), block_at({0.034, 0.01, kOnFloor_m}),
                                    block_at({-0.01, 0.05, kOnFloor_m})};
  for (const double x_m : {-0.006, -0.003, 0.0, 0.003, 0.006}) {
    for (const double y_m : {-0.02, 0.0, 0.02}) {
      const TrueGrasp grasp = grasp_at({x_m, y_m, 0.006});
      const Finding expected = finding(parts, grasp);
      for (const double turn_rad : {0.3, 1.4, 2.9}) {
        const Eigen::AngleAxisd turn(turn_rad, Vector3d::UnitZ());
        std::vector<TruePart> turned = parts;
        for (TruePart& part : turned) part.T_bin_part = turn * part.T_bin_part;
        TrueGrasp turned_grasp = grasp;
        turned_grasp.T_bin_grasp = turn * grasp.T_bin_grasp;
        EXPECT_EQ(finding(turned, turned_grasp), expected)
            << x_m << ", " << y_m << ", by " << turn_rad;
      }
    }
  }
}

TEST_F(Judge, WhatCarriesAnotherDoesNotLiftFree) {
  const GraspJudge judge = judge_of(
      {block_at(on_floor_), block_at({0.005, 0, 0.0325}), block_at({-0.05, 0, kOnFloor_m})});
  EXPECT_FALSE(judge.lifts_free(0));
  EXPECT_TRUE(judge.lifts_free(1));
  EXPECT_TRUE(judge.lifts_free(2));
}

TEST_F(Judge, TheSearchFindsWhatTheJudgeCallsGood) {
  const GraspJudge judge = judge_of({block_at(on_floor_), block_at({0.021, 0, kOnFloor_m})});
  const SearchResult found = find_good_grasp(judge);
  ASSERT_TRUE(found.grasp);
  EXPECT_EQ(judge.judge(*found.grasp).finding, Finding::kGood);
}

TEST_F(Judge, TheSearchFindsNothingWhereNothingIs) {
  const parts::Part cube = testing::block_part("cube", {0.09, 0.09, 0.09});
  const SearchResult found =
      find_good_grasp(judge_of({{&cube, Eigen::Isometry3d(Translation3d(0, 0, 0.05))}}));
  EXPECT_FALSE(found.grasp);
  EXPECT_TRUE(found.is_complete);
}

TEST_F(Judge, TheSearchGivesUp) {
  std::vector<TruePart> wall;  // too close to each other for any jaw
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) wall.push_back(block_at({0.0205 * i, 0.0605 * j, kOnFloor_m}));
  }
  SearchOptions options;
  options.give_up_after = std::chrono::milliseconds(0);
  EXPECT_FALSE(find_good_grasp(judge_of(wall), options).is_complete);
}

}  // namespace
}  // namespace graspd::judge
