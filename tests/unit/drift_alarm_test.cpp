#include "graspd/agent/drift_alarm.hpp"

#include <gmock/gmock.h>

namespace graspd::agent {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

PlanAnswer off_by(double drift_m) {
  PlanAnswer answer;
  answer.bin_drift_m = drift_m;
  return answer;
}

TEST(DriftAlarm, IsRaisedOnceAfterSeveralAnswersInARow) {
  DriftAlarm alarm({0.006, 3});
  EXPECT_FALSE(alarm.see(off_by(0.008)));
  EXPECT_FALSE(alarm.see(off_by(0.009)));
  const auto raised = alarm.see(off_by(0.0085));
  ASSERT_TRUE(raised);
  EXPECT_THAT(*raised, AllOf(HasSubstr("8.0 to 9.0 mm"), HasSubstr("3 frames")));
  EXPECT_FALSE(alarm.see(off_by(0.009)));
  EXPECT_EQ(alarm.over_limit_n(), 4U);
}

TEST(DriftAlarm, AGoodAnswerBetweenStartsAnew) {
  DriftAlarm alarm({0.006, 2});
  EXPECT_FALSE(alarm.see(off_by(0.008)));
  EXPECT_FALSE(alarm.see({}));
  EXPECT_FALSE(alarm.see(off_by(0.008)));
  EXPECT_FALSE(alarm.see(off_by(0.005)));
  EXPECT_FALSE(alarm.see(off_by(0.008)));
  EXPECT_TRUE(alarm.see(off_by(0.008)));
  EXPECT_FALSE(alarm.see({}));
  EXPECT_FALSE(alarm.see(off_by(0.008)));
  EXPECT_TRUE(alarm.see(off_by(0.008)));  // again, after it was good
}

}  // namespace
}  // namespace graspd::agent
