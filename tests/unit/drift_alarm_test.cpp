#include "graspd/agent/drift_alarm.hpp"

#include <gmock/gmock.h>

#include "graspd/perception/bin_drift.hpp"

namespace graspd::agent {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// An answer in the server's own words, so that a change of them is noticed here.
PlanAnswer off_by(double drift_m) {
  PlanAnswer answer;
  answer.warnings = {"another warning",
                     perception::sentence_of({Eigen::Vector2d(drift_m, 0), 0, drift_m})};
  return answer;
}

TEST(BinDrift, IsReadInWarningOrReason) {
  EXPECT_NEAR(bin_drift_m(off_by(0.0084)).value(), 0.0084, 1e-6);
  PlanAnswer not_found;
  not_found.outcome = Outcome::kBinNotFound;
  not_found.reason = off_by(0.042).warnings[1];
  EXPECT_NEAR(bin_drift_m(not_found).value(), 0.042, 1e-6);
  EXPECT_FALSE(bin_drift_m({}));
  PlanAnswer other;
  other.warnings = {"the bin lies in the sun", "its rim by up to 9 mm"};
  EXPECT_FALSE(bin_drift_m(other));
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
