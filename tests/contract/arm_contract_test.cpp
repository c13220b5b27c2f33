#include <gmock/gmock.h>

#include <limits>

#include "arm_rigs.hpp"

/// What every arm owes the pick cycle, run on each of them.
namespace graspd::agent {
namespace {

using testing::MotionCell;
using ::testing::Optional;
using ::testing::StartsWith;

constexpr double kTolerance_m = 1e-4;
constexpr double kTolerance_rad = 1e-3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ArmContract : public ::testing::TestWithParam<testing::NamedArmRig> {
 protected:
  Arm& arm() { return rig_->arm(); }
  std::optional<Eigen::Isometry3d> T_base_grasp() { return rig_->T_base_grasp(); }

  static bool is_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.translation() - b.translation()).norm() < kTolerance_m &&
           testing::turn_between(a, b) < kTolerance_rad;
  }
  /// At the pose, or there turned by 180°.
  void expect_at(const Eigen::Isometry3d& T) {
    const auto now = T_base_grasp();
    ASSERT_TRUE(now);
    const Eigen::Isometry3d turned = T * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(is_same(*now, T) || is_same(*now, turned)) << now->matrix();
  }
  void expect_done(const Result<void>& done) { EXPECT_TRUE(done) << done.error().message; }
  /// Neither planned nor done, alone or after one that can be; and nothing has moved.
  void expect_refused(const Motion& motion) {
    const auto before = T_base_grasp();
    const std::string step(name_of(motion.step));
    EXPECT_THAT(arm().why_not({{motion}}), Optional(StartsWith(step + ": ")));
    EXPECT_THAT(arm().why_not({{above, motion}}), Optional(StartsWith(step + ": ")));
    const auto done = arm().move(motion);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Code::kInvalidArgument);
    EXPECT_THAT(done.error().message, StartsWith(step + ": "));
    const auto after = T_base_grasp();
    ASSERT_EQ(after.has_value(), before.has_value());
    if (after) {
      EXPECT_TRUE(after->isApprox(*before, 0)) << "it has moved";
    }
  }

  const std::unique_ptr<testing::ArmRig> rig_ = GetParam().make();
  const Motion above{Step::kPreGrasp, Path::kFree, MotionCell::down(0.31, 0.03, 0.22), 1, 0.04};
  const Motion down{Step::kApproach, Path::kStraight, MotionCell::down(0.31, 0.03, 0.15), 1, 0.04};
  const Motion aside{Step::kTransfer, Path::kFree, MotionCell::down(0.25, 0.15, 0.25), 1, 0.04};
};

TEST_P(ArmContract, StandsAtThePoseWhenAMotionIsOver) {
  for (const Motion& motion : {above, down, above, aside}) {
    expect_done(arm().move(motion));
    expect_at(motion.T_base_grasp);
  }
}

TEST_P(ArmContract, AMotionToWhereItStandsIsDone) {
  for (int i = 0; i < 2; ++i) {
    expect_done(arm().move(above));
    expect_at(above.T_base_grasp);
  }
}

TEST_P(ArmContract, WhatItCanDoItDoes) {
  EXPECT_EQ(arm().why_not({{above, down, aside}}), std::nullopt);
  for (const Motion& motion : {above, down, aside}) {
    expect_done(arm().move(motion));
    expect_at(motion.T_base_grasp);
  }
}

TEST_P(ArmContract, ToAskMovesNothingAndBindsNobody) {
  expect_done(arm().move(above));
  EXPECT_EQ(arm().why_not({}), std::nullopt);
  EXPECT_EQ(arm().why_not({{down}}), std::nullopt);
  expect_at(above.T_base_grasp);
  expect_done(arm().move(aside));
  expect_at(aside.T_base_grasp);
}

TEST_P(ArmContract, OutOfViewIsWhereItWasBefore) {
  expect_done(arm().move_out_of_view());
  const auto home = T_base_grasp();
  expect_done(arm().move(above));
  expect_done(arm().move_out_of_view());
  expect_done(arm().move_out_of_view());
  const auto again = T_base_grasp();
  ASSERT_EQ(again.has_value(), home.has_value());
  if (home) {
    EXPECT_TRUE(is_same(*again, *home)) << again->matrix();
  }
}

TEST_P(ArmContract, StandsAfterAStopAndMovesAgain) {
  expect_done(arm().stop());  // before the first motion
  expect_done(arm().move(above));
  EXPECT_EQ(arm().why_not({{down}}), std::nullopt);
  expect_done(arm().stop());
  expect_done(arm().stop());
  expect_at(above.T_base_grasp);
  expect_done(arm().move(down));
  expect_at(down.T_base_grasp);
}

TEST_P(ArmContract, WhatItIsToKeepClearOfIsToldAtAnyTime) {
  const MotionCell cell;
  arm().set_surroundings(cell.around);
  expect_done(arm().move(above));
  EXPECT_EQ(arm().why_not({{down}}), std::nullopt);
  arm().set_surroundings(cell.around);
  expect_done(arm().move(down));
  expect_at(down.T_base_grasp);
  arm().set_surroundings({});
  expect_done(arm().move(above));
  expect_at(above.T_base_grasp);
}

TEST_P(ArmContract, APoseThatIsNoneIsRefused) {
  expect_done(arm().move(above));
  for (const Path path : {Path::kFree, Path::kStraight}) {
    Motion motion = down;
    motion.path = path;
    motion.T_base_grasp.translation().x() = kNan;
    expect_refused(motion);
    motion = down;
    motion.path = path;
    motion.T_base_grasp.linear() *= 2;
    expect_refused(motion);
    motion.T_base_grasp.linear().setZero();
    expect_refused(motion);
  }
}

TEST_P(ArmContract, ASpeedThatIsNoneIsRefused) {
  for (const double share : {0.0, -0.5, 1.5, kNan}) {
    Motion motion = above;
    motion.speed_share = share;
    expect_refused(motion);
  }
}

TEST_P(ArmContract, AnOpeningThatIsNoneIsRefused) {
  for (const double width_m : {-0.01, kNan, std::numeric_limits<double>::infinity()}) {
    Motion motion = above;
    motion.opening_width_m = width_m;
    expect_refused(motion);
  }
}

TEST_P(ArmContract, APoseOutOfReachIsRefused) {
  const auto T = rig_->T_base_unreachable();
  if (!T) GTEST_SKIP() << "every pose is within its reach";
  for (const Path path : {Path::kFree, Path::kStraight}) {
    expect_refused({Step::kPlace, path, *T, 1, 0.04});
  }
}

TEST_P(ArmContract, AShareOfTheSpeedTakesLonger) {
  Clock* clock = rig_->clock();
  if (clock == nullptr) GTEST_SKIP() << "its motions take no time";
  const auto time_of = [&](Motion motion, double share) {
    motion.speed_share = share;
    const auto start = clock->now();
    expect_done(arm().move(motion));
    return std::chrono::duration<double>(clock->now() - start).count();
  };
  expect_done(arm().move(above));
  for (const auto& [there, back] : {std::pair(down, above), std::pair(aside, above)}) {
    const double whole_s = time_of(there, 1);
    expect_done(arm().move(back));
    EXPECT_GT(time_of(there, 0.25), 1.3 * whole_s) << name_of(there.step);
    expect_done(arm().move(back));
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, ArmContract, ::testing::ValuesIn(testing::kArmRigs),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace graspd::agent
