#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/trials/history.hpp"

// The checker catches each kind of violation, and nothing else.
namespace graspd::trials {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr RequestId kFirst{1};
constexpr RequestId kSecond{2};
constexpr milliseconds kBudget{1000};
const TimePoint kStart{};

class HistoryTest : public ::testing::Test {
 protected:
  HistoryTest() {
    history.asked(kFirst, 7, kStart, kBudget);
    history.asked(kSecond, 7, kStart, kBudget);
  }
  void answer_both() {
    history.answered(kFirst, kStart + milliseconds(5), 7, 99);
    history.answered(kSecond, kStart + milliseconds(10), 7, 99);
  }
  History history;
};

TEST_F(HistoryTest, IsContentWithOneAnswerEach) {
  answer_both();
  EXPECT_THAT(history.violations(), IsEmpty());
  const Tally tally = history.tally();
  EXPECT_EQ(tally.asked_n, 2);
  EXPECT_EQ(tally.ok_n(), 2);
  EXPECT_EQ(tally.quantile_ms(0.5), 10);
  EXPECT_EQ(tally.quantile_ms(1), 10);
}

TEST_F(HistoryTest, IsContentWithARefusalAndADeadline) {
  history.refused(kFirst, kStart + milliseconds(1), Code::kBusy);
  history.refused(kSecond, kStart + kBudget + History::kSlack, Code::kDeadlineExceeded);
  EXPECT_THAT(history.violations(), IsEmpty());
  EXPECT_EQ(history.tally().ended_n.at(Code::kBusy), 1);
  EXPECT_EQ(history.tally().ok_n(), 0);
}

TEST_F(HistoryTest, SeesSilence) {
  history.answered(kFirst, kStart, 7, 99);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("never ended")));
}

TEST_F(HistoryTest, SeesASecondAnswer) {
  answer_both();
  history.answered(kSecond, kStart + milliseconds(20), 7, 99);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("ended twice")));
}

TEST_F(HistoryTest, SeesARefusalAfterAnAnswer) {
  answer_both();
  history.refused(kSecond, kStart + milliseconds(20), Code::kInternal);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("ended twice")));
}

TEST_F(HistoryTest, SeesAnAnswerToAnotherQuestion) {
  history.answered(kFirst, kStart, 8, 99);
  history.answered(kSecond, kStart, 7, 99);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("got the answer to question 8")));
}

TEST_F(HistoryTest, SeesAnAnswerToNoRequest) {
  answer_both();
  history.answered(RequestId{3}, kStart, 7, 99);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("never asked")));
}

TEST_F(HistoryTest, SeesTwoAnswersToOneQuestion) {
  history.answered(kFirst, kStart, 7, 99);
  history.answered(kSecond, kStart, 7, 98);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("another answer")));
}

TEST_F(HistoryTest, SeesAnEndThatIsLate) {
  history.answered(kFirst, kStart + kBudget + History::kSlack + milliseconds(1), 7, 99);
  history.answered(kSecond, kStart, 7, 99);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("its budget was 1000 ms")));
}

TEST_F(HistoryTest, SeesAnIdThatIsUsedTwice) {
  answer_both();
  history.asked(kFirst, 9, kStart, kBudget);
  EXPECT_THAT(history.violations(), ElementsAre(HasSubstr("asked twice")));
}

}  // namespace
}  // namespace graspd::trials
