#include <gmock/gmock.h>

#include <vector>

#include "graspd/motion/planned_arm.hpp"
#include "motion_cell.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::MotionCell;
using ::testing::HasSubstr;
using ::testing::Optional;
using ::testing::StartsWith;

/// An arm that is at once where it is told to be.
class ScriptedDriver final : public agent::JointDriver {
 public:
  Result<agent::Joints> joints() override {
    if (away) return fail(Code::kUnavailable, "no state for 1 s");
    return at_rad;
  }
  Result<void> follow(const agent::JointTrajectory& trajectory) override {
    followed.push_back(trajectory);
    if (fails) return fail(Code::kUnavailable, "emergency stop");
    at_rad = trajectory.back().q_rad;
    return {};
  }
  Result<void> stop() override {
    ++stops_n;
    if (away) return fail(Code::kUnavailable, "no answer");
    return {};
  }

  agent::Joints at_rad;
  bool away = false;
  bool fails = false;
  int stops_n = 0;
  std::vector<agent::JointTrajectory> followed;
};

class Arm : public ::testing::Test {
 protected:
  Arm() {
    driver.at_rad = cell.out_of_view_rad;
    arm = PlannedArm::create(driver, {cell.arm, cell.parameters, cell.out_of_view_rad}).value();
    arm->set_surroundings(cell.around);
  }

  double distance_m(const Eigen::Isometry3d& T) const {
    return (cell.T_base_grasp(driver.at_rad).translation() - T.translation()).norm();
  }

  MotionCell cell;
  ScriptedDriver driver;
  std::unique_ptr<PlannedArm> arm;
  agent::PickMotions pick = cell.pick_at(MotionCell::down(0.31, 0.02, 0.03));
};

TEST_F(Arm, DoesWhatItHasPlannedAndClearsTheView) {
  const auto motions = pick.all();
  EXPECT_EQ(arm->why_not(motions), std::nullopt);
  EXPECT_TRUE(driver.followed.empty()) << "asking moves nothing";
  for (const agent::Motion& motion : motions) {
    const agent::Joints before_rad = driver.at_rad;
    ASSERT_TRUE(arm->move(motion));
    EXPECT_EQ(driver.followed.back().front().q_rad, before_rad);
    EXPECT_LT(distance_m(motion.T_base_grasp), 1e-6);
  }
  ASSERT_TRUE(arm->move_out_of_view());
  EXPECT_TRUE(driver.at_rad.isApprox(cell.out_of_view_rad, 1e-9));
  EXPECT_EQ(driver.followed.size(), 7U);
}

TEST_F(Arm, PlansAMotionThatNobodyAskedFor) {
  ASSERT_TRUE(arm->move(pick.pre_grasp));
  ASSERT_TRUE(arm->move(pick.approach));
  EXPECT_LT(distance_m(pick.approach.T_base_grasp), 1e-6);
}

TEST_F(Arm, PlansAnewWhereItWasMovedMeanwhile) {
  EXPECT_EQ(arm->why_not(pick.all()), std::nullopt);
  driver.at_rad[0] += 0.2;
  const agent::Joints pushed_rad = driver.at_rad;
  ASSERT_TRUE(arm->move(pick.pre_grasp));
  EXPECT_EQ(driver.followed.back().front().q_rad, pushed_rad);
  EXPECT_LT(distance_m(pick.pre_grasp.T_base_grasp), 1e-6);
}

TEST_F(Arm, PlansAnewWhereThingsStandDifferently) {
  EXPECT_EQ(arm->why_not(pick.all()), std::nullopt);
  for (int cm = 25; cm < 37; ++cm) {
    cell.around.p_base_m.emplace_back(0.01F * static_cast<float>(cm), 0.02F, 0.3F);
  }
  arm->set_surroundings(cell.around);
  const auto moved = arm->move(pick.pre_grasp);
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().message, HasSubstr("what the camera saw"));
  EXPECT_TRUE(driver.followed.empty());
}

TEST_F(Arm, SaysWhyNotAndDoesNotMove) {
  const auto motions = cell.pick_at(MotionCell::down(0.9, 0, 0.03)).all();
  EXPECT_THAT(arm->why_not(motions), Optional(StartsWith("pre_grasp: out of reach")));
  const auto moved = arm->move(motions.front());
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().message, StartsWith("pre_grasp: out of reach"));
  EXPECT_TRUE(driver.followed.empty());
}

TEST_F(Arm, AnErrorOfTheControllerIsPassedOnAndThePlanForgotten) {
  EXPECT_EQ(arm->why_not(pick.all()), std::nullopt);
  driver.fails = true;
  const auto moved = arm->move(pick.pre_grasp);
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().message, "emergency stop");
  driver.fails = false;
  ASSERT_TRUE(arm->move(pick.pre_grasp)) << "the way is planned anew from where the arm stands";
  EXPECT_EQ(driver.followed.back().front().q_rad, cell.out_of_view_rad);
}

TEST_F(Arm, AControllerThatSaysNothingOrNonsenseMovesNothing) {
  driver.away = true;
  EXPECT_THAT(arm->why_not(pick.all()), Optional(HasSubstr("no state for 1 s")));
  EXPECT_FALSE(arm->move(pick.pre_grasp));
  EXPECT_FALSE(arm->move_out_of_view());
  driver.away = false;
  driver.at_rad = agent::Joints::Zero(4);
  EXPECT_THAT(arm->why_not(pick.all()), Optional(HasSubstr("tells of 4 joints")));
  EXPECT_TRUE(driver.followed.empty());
}

TEST_F(Arm, BeyondItsLimitsItDoesNotClearTheViewEither) {
  driver.at_rad[2] = 4.1;
  const auto moved = arm->move_out_of_view();
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().message, StartsWith("out_of_view: the arm stands beyond its limits"));
  EXPECT_TRUE(driver.followed.empty());
}

TEST_F(Arm, StopsItsController) {
  EXPECT_EQ(arm->why_not(pick.all()), std::nullopt);
  EXPECT_TRUE(arm->stop());
  EXPECT_EQ(driver.stops_n, 1);
  driver.away = true;
  EXPECT_FALSE(arm->stop()) << "it may be moving";
}

TEST_F(Arm, APlaceOutOfViewThatIsNoneIsRefused) {
  const auto of_four =
      PlannedArm::create(driver, {cell.arm, cell.parameters, agent::Joints::Zero(4)});
  ASSERT_FALSE(of_four);
  EXPECT_THAT(of_four.error().message, HasSubstr("out of view: 4 joints"));
  cell.out_of_view_rad[1] = 3;
  const auto beyond = PlannedArm::create(driver, {cell.arm, cell.parameters, cell.out_of_view_rad});
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, HasSubstr("out of view: joint_2 would be at 3.000 rad"));
}

}  // namespace
}  // namespace graspd::motion
