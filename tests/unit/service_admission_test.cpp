#include <gtest/gtest.h>

#include <set>

#include "graspd/service/admission.hpp"
#include "start_time.hpp"

namespace graspd::service {
namespace {

using std::chrono::milliseconds;

Waiting waiting(Ticket ticket, std::string cell, milliseconds budget) {
  return {ticket, std::move(cell), kStart + budget};
}

/// One request that takes `service_time`, so that the admission has something to predict from.
void teach(Admission& admission, milliseconds service_time) {
  admission.admit({1, "teacher", kStart + std::chrono::hours(1)}, kStart - service_time);
  admission.start(kStart - service_time);
  admission.finish(1, kStart, true);
}

TEST(Admission, NothingLeftOfTheBudgetIsDeadlineExceeded) {
  Admission admission(1, 1);
  const auto verdict = admission.admit(waiting(2, "a", milliseconds(0)), kStart);
  ASSERT_TRUE(verdict.refusal);
  EXPECT_EQ(verdict.refusal->error.code, Code::kDeadlineExceeded);
  EXPECT_EQ(admission.queued_n(), 0u);
}

TEST(Admission, AdmitsEverythingBeforeTheFirstMeasurement) {
  Admission admission(1, 1);
  for (Ticket ticket = 0; ticket < 20; ++ticket) {
    const auto verdict =
        admission.admit(waiting(ticket, "cell" + std::to_string(ticket), milliseconds(1)), kStart);
    EXPECT_FALSE(verdict.refusal);
  }
}

TEST(Admission, AnIdleServerAdmitsEvenWhatIsUsuallySlow) {
  Admission admission(1, 1);
  teach(admission, milliseconds(4000));
  EXPECT_FALSE(admission.admit(waiting(2, "a", milliseconds(100)), kStart).refusal);
}

TEST(Admission, PredictedWaitIsWorkAheadTimesMeanServiceTimeByWorkers) {
  Admission admission(2, 1);
  teach(admission, milliseconds(100));
  Ticket ticket = 2;
  for (const char* cell : {"a", "b"}) {
    admission.admit(waiting(ticket++, cell, milliseconds(10'000)), kStart);
    admission.start(kStart);
  }
  for (const char* cell : {"c", "d", "e"}) {
    admission.admit(waiting(ticket++, cell, milliseconds(10'000)), kStart);
  }
  // Two run and three wait: 5 × 100 ms / 2.
  EXPECT_EQ(admission.predicted_wait("f"), milliseconds(250));
  // Its own queued frame would start first, then one turn of each other cell.
  EXPECT_EQ(admission.predicted_wait("c"), milliseconds(250));
}

TEST(Admission, BusyWhereTheWaitIsLongerThanTheBudget) {
  Admission admission(1, 1);
  teach(admission, milliseconds(100));
  admission.admit(waiting(2, "a", milliseconds(10'000)), kStart);
  admission.start(kStart);
  admission.admit(waiting(3, "b", milliseconds(10'000)), kStart);

  const auto busy = admission.admit(waiting(4, "c", milliseconds(150)), kStart);
  ASSERT_TRUE(busy.refusal);
  EXPECT_EQ(busy.refusal->error.code, Code::kBusy);
  EXPECT_GE(busy.refusal->retry_after_ms, 150u) << "200 ms of work, jittered by a quarter";
  EXPECT_LE(busy.refusal->retry_after_ms, 250u);
  EXPECT_EQ(admission.queued_n(), 1u);

  EXPECT_FALSE(admission.admit(waiting(5, "c", milliseconds(250)), kStart).refusal);
}

TEST(Admission, JitterSpreadsTheRetries) {
  Admission admission(1, 1);
  teach(admission, milliseconds(1000));
  admission.admit(waiting(2, "a", milliseconds(10'000)), kStart);
  admission.start(kStart);
  std::set<std::uint32_t> retries;
  for (Ticket ticket = 3; ticket < 23; ++ticket) {
    retries.insert(
        admission.admit(waiting(ticket, "b", milliseconds(10)), kStart).refusal->retry_after_ms);
  }
  EXPECT_GT(retries.size(), 15u);
}

TEST(Admission, NamesTheSupersededRequest) {
  Admission admission(1, 1);
  EXPECT_FALSE(admission.admit(waiting(1, "a", milliseconds(100)), kStart).superseded);
  EXPECT_FALSE(admission.admit(waiting(2, "a", milliseconds(100)), kStart).superseded);
  EXPECT_EQ(admission.admit(waiting(3, "a", milliseconds(100)), kStart).superseded, 1u);
}

TEST(Admission, FailedRequestsDoNotTeachTheMean) {
  Admission admission(1, 1);
  teach(admission, milliseconds(100));
  admission.admit(waiting(2, "a", milliseconds(10'000)), kStart);
  admission.start(kStart);
  admission.finish(2, kStart + milliseconds(9000), false);
  admission.admit(waiting(3, "a", milliseconds(10'000)), kStart);
  admission.start(kStart);
  EXPECT_EQ(admission.predicted_wait("b"), milliseconds(100));
}

}  // namespace
}  // namespace graspd::service
