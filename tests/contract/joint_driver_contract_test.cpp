#include <gmock/gmock.h>

#include <limits>

#include "joint_driver_rigs.hpp"

/// What every driver of an arm must do, run on each of them.
namespace graspd::agent {
namespace {

using ::testing::HasSubstr;

/// Of a goal: what the arm's controllers promise.
constexpr double kTolerance_rad = 0.01;

class JointDriverContract : public ::testing::TestWithParam<testing::NamedRig> {
 protected:
  Joints joints() {
    const auto q_rad = driver().joints();
    EXPECT_TRUE(q_rad) << q_rad.error().message;
    return q_rad.value_or(Joints());
  }
  JointDriver& driver() { return rig_->driver(); }

  /// From where the arm stands by these steps, `step_s` each.
  JointTrajectory trajectory(std::initializer_list<double> steps_rad, double step_s = 0.1) {
    JointTrajectory points{{0, joints()}};
    for (const double step_rad : steps_rad) {
      const JointPoint& last = points.back();
      const Joints step = Joints::Constant(last.q_rad.size(), step_rad);
      points.push_back({last.t_s + step_s, last.q_rad + step});
    }
    return points;
  }

  void expect_at(const Joints& goal_rad) {
    EXPECT_LE((joints() - goal_rad).cwiseAbs().maxCoeff(), kTolerance_rad);
  }

  /// Refused with a sentence that holds `why`, and nothing has moved.
  void expect_refused(const JointTrajectory& trajectory, const std::string& why) {
    const Joints before = joints();
    const auto done = driver().follow(trajectory);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Code::kInvalidArgument);
    EXPECT_THAT(done.error().message, HasSubstr(why));
    EXPECT_EQ((joints() - before).cwiseAbs().maxCoeff(), 0);
  }

 private:
  std::unique_ptr<testing::JointDriverRig> rig_ = GetParam().make();
};

TEST_P(JointDriverContract, KnowsWhereTheArmStands) {
  const Joints q_rad = joints();
  EXPECT_GT(q_rad.size(), 0);
  EXPECT_TRUE(q_rad.allFinite());
  EXPECT_EQ(joints(), q_rad);
}

TEST_P(JointDriverContract, StandsAtTheLastPointWhenAMotionIsOver) {
  const JointTrajectory there = trajectory({0.05, 0.05, -0.02});
  const auto done = driver().follow(there);
  ASSERT_TRUE(done) << done.error().message;
  expect_at(there.back().q_rad);
}

TEST_P(JointDriverContract, FollowsOneMotionAfterTheOther) {
  const Joints home = joints();
  ASSERT_TRUE(driver().follow(trajectory({0.1})));
  ASSERT_TRUE(driver().follow(trajectory({-0.1})));
  expect_at(home);
}

TEST_P(JointDriverContract, AWayBackToWhereItBeganIsGone) {
  const JointTrajectory round = trajectory({0.1, -0.1});
  ASSERT_TRUE(driver().follow(round));
  expect_at(round.front().q_rad);
}

TEST_P(JointDriverContract, AMotionToWhereTheArmStandsIsDone) {
  ASSERT_TRUE(driver().follow(trajectory({})));
  ASSERT_TRUE(driver().follow(trajectory({0.0})));
}

TEST_P(JointDriverContract, MovesAgainAfterAStop) {
  for (int i = 0; i < 2; ++i) {
    const auto stopped = driver().stop();
    EXPECT_TRUE(stopped) << stopped.error().message;
  }
  const JointTrajectory there = trajectory({0.05});
  const auto done = driver().follow(there);
  ASSERT_TRUE(done) << done.error().message;
  expect_at(there.back().q_rad);
}

TEST_P(JointDriverContract, ATrajectoryWithoutPointsIsRefused) { expect_refused({}, "no points"); }

TEST_P(JointDriverContract, AnotherNumberOfJointsIsRefused) {
  JointTrajectory wrong = trajectory({0.05});
  wrong.back().q_rad = Joints::Zero(wrong.back().q_rad.size() + 1);
  expect_refused(wrong, "joints");
}

TEST_P(JointDriverContract, TimesThatDoNotIncreaseAreRefused) {
  JointTrajectory wrong = trajectory({0.05, 0.05});
  wrong[2].t_s = wrong[1].t_s;
  expect_refused(wrong, "times increase");
  wrong = trajectory({0.05});
  wrong[0].t_s = 0.05;
  expect_refused(wrong, "times increase");
}

TEST_P(JointDriverContract, NumbersThatAreNoneAreRefused) {
  JointTrajectory wrong = trajectory({0.05});
  wrong.back().q_rad[0] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(wrong, "not finite");
}

TEST_P(JointDriverContract, AMotionThatStartsElsewhereIsRefused) {
  JointTrajectory wrong = trajectory({0.05});
  for (JointPoint& point : wrong) point.q_rad[0] += 0.3;
  expect_refused(wrong, "joint 1");
}

INSTANTIATE_TEST_SUITE_P(Arms, JointDriverContract, ::testing::ValuesIn(testing::kRigs),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace graspd::agent
