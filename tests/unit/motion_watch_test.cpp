#include "graspd/agent/motion_watch.hpp"

#include <gmock/gmock.h>

namespace graspd::agent {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

Joints at(double q_rad) { return Joints::Constant(6, q_rad); }

class MotionWatchTest : public ::testing::Test {
 protected:
  MotionWatch watch{{{0, at(0)}, {1.0, at(0.5)}}, {}, 10s};
};

TEST_F(MotionWatchTest, HasArrivedWhenItWasSeenToMoveAndStandsAtTheGoal) {
  EXPECT_FALSE(watch.has_arrived(at(0), false, 10s));
  EXPECT_FALSE(watch.has_arrived(at(0.3), true, 10500ms));
  EXPECT_FALSE(watch.has_arrived(at(0.5), true, 10900ms));
  EXPECT_TRUE(watch.has_arrived(at(0.495), false, 10950ms));
}

TEST_F(MotionWatchTest, StandsShortOfTheGoal) {
  EXPECT_FALSE(watch.has_arrived(at(0.4), true, 10500ms));
  EXPECT_FALSE(watch.has_arrived(at(0.489), false, 12s));
}

TEST_F(MotionWatchTest, OneJointThatIsNotThereIsEnough) {
  Joints almost = at(0.5);
  almost[4] += 0.02;
  EXPECT_FALSE(watch.has_arrived(almost, false, 12s));
}

TEST_F(MotionWatchTest, AWayBackIsNotDoneBeforeItHasBegun) {
  MotionWatch round({{0, at(0)}, {1.0, at(0.5)}, {2.0, at(0)}}, {}, 10s);
  EXPECT_FALSE(round.has_arrived(at(0), false, 10100ms));
  EXPECT_FALSE(round.has_arrived(at(0.2), true, 10300ms));
  EXPECT_TRUE(round.has_arrived(at(0), false, 12100ms));
}

TEST_F(MotionWatchTest, WhereMotionIsUnknownTheJointsTell) {
  EXPECT_FALSE(watch.has_arrived(at(0.3), std::nullopt, 10500ms));
  EXPECT_FALSE(watch.has_arrived(at(0.499), std::nullopt, 10900ms));
  EXPECT_TRUE(watch.has_arrived(at(0.499), std::nullopt, 11s));
}

TEST_F(MotionWatchTest, OvertimeEndsAndNamesTheFarthestJoint) {
  Joints stuck = at(0.5);
  stuck[2] = 0.1;
  EXPECT_FALSE(watch.has_arrived(stuck, true, 11s));
  EXPECT_TRUE(watch.in_time(15900ms));
  const auto late = watch.in_time(16100ms);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, Code::kDeadlineExceeded);
  EXPECT_THAT(late.error().message, HasSubstr("joint 3 is 0.400 rad"));
}

}  // namespace
}  // namespace graspd::agent
