#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "graspd/load/capacity.hpp"

namespace graspd::load {
namespace {

using ::testing::ElementsAre;

std::vector<Due> first_of(const Pace& pace, int n) {
  std::vector<Due> dues;
  for (int i = 0; i < n; ++i) dues.push_back(pace());
  return dues;
}

double seconds_since(TimePoint start, TimePoint at) {
  return std::chrono::duration<double>(at - start).count();
}

TEST(Pace, FixedLetsCellsTakeTurnsAtEqualDistances) {
  const TimePoint start = Clock::now();
  const auto dues = first_of(fixed_pace(start, 10, 3), 100);
  for (std::size_t i = 0; i < dues.size(); ++i) {
    EXPECT_EQ(dues[i].cell, i % 3);
    EXPECT_NEAR(seconds_since(start, dues[i].at), static_cast<double>(i) / 10, 1e-8);
  }
}

TEST(Pace, PoissonHasTheRateTheSpreadAndTheFairnessOfOne) {
  const TimePoint start = Clock::now();
  constexpr int kDues_n = 20'000;
  const auto dues = first_of(poisson_pace(start, 100, 4, 1), kDues_n);
  const double length_s = seconds_since(start, dues.back().at);
  EXPECT_NEAR(kDues_n / length_s, 100, 3);
  // Of a Poisson process the count in a second varies by as much as its mean.
  std::map<int, int> counts;
  std::map<std::size_t, int> cells;
  for (const Due& due : dues) {
    ++counts[static_cast<int>(seconds_since(start, due.at))];
    ++cells[due.cell];
  }
  double variance = 0;
  for (const auto& [second, count] : counts) variance += (count - 100.0) * (count - 100.0);
  EXPECT_NEAR(variance / static_cast<double>(counts.size()), 100, 35);
  for (const auto& [cell, count] : cells) EXPECT_NEAR(count, kDues_n / 4.0, 250);
}

TEST(Pace, RecordedRepeatsEachCellsOwnDistances) {
  const TimePoint start = Clock::now();
  const Pace pace = recorded_pace(start, {{100, 101, 103}, {7, 7.25}});
  std::map<std::size_t, std::vector<double>> times_s;
  TimePoint last = start;
  for (const Due& due : first_of(pace, 24)) {
    EXPECT_GE(due.at, last) << "not in the order of time";
    last = due.at;
    times_s[due.cell].push_back(seconds_since(start, due.at));
  }
  // The pause before the next round is as long as those within, at the mean.
  EXPECT_THAT((std::vector(times_s[0].begin(), times_s[0].begin() + 4)), ElementsAre(0, 1, 3, 4.5));
  EXPECT_THAT((std::vector(times_s[1].begin(), times_s[1].begin() + 4)),
              ElementsAre(0, 0.25, 0.5, 0.75));
}

TEST(Pace, RecordedRefusesFramesThatDontSayWhen) {
  EXPECT_THROW(recorded_pace(Clock::now(), {{}}), std::invalid_argument);
  EXPECT_THROW(recorded_pace(Clock::now(), {{1}}), std::invalid_argument);
  EXPECT_THROW(recorded_pace(Clock::now(), {{0, 1}, {2, 2}}), std::invalid_argument);
}

Summary window(double goodput_hz, double p50_ms) {
  Summary made;
  made.goodput_hz = goodput_hz;
  made.latency_ms.p50 = p50_ms;
  return made;
}

TEST(Stability, IsThreeWindowsWithinTenPercentOfTheirMean) {
  EXPECT_FALSE(are_stable({window(10, 50), window(10, 50)}));
  EXPECT_TRUE(are_stable({window(1, 500), window(10, 50), window(10.5, 52), window(9.8, 47)}));
  EXPECT_FALSE(are_stable({window(10, 50), window(10, 50), window(12.5, 50)})) << "goodput";
  EXPECT_FALSE(are_stable({window(10, 50), window(10, 60), window(10, 70)})) << "latency";
}

/// A service of this capacity: no queue below it, answers at its own speed above.
load::Run run_of(double rate_hz, double capacity_hz) {
  load::Run run;
  run.is_open = true;
  run.rate_hz = rate_hz;
  run.summary.asked_hz = rate_hz;
  run.summary.goodput_hz = std::min(rate_hz, capacity_hz);
  run.summary.ok_n = 100;
  return run;
}

class CapacityOf : public ::testing::TestWithParam<double> {};

TEST_P(CapacityOf, IsFoundFromAPeakThatIsTooLowOrTooHigh) {
  load::Run peak;
  peak.summary.goodput_hz = GetParam();
  int tried_n = 0;
  const Capacity found = find_capacity(peak, [&](double rate_hz) {
    ++tried_n;
    return run_of(rate_hz, 100);
  });
  // Answers may fall behind by 2 %, and the search is as exact as that.
  EXPECT_GE(found.capacity_hz, 98);
  EXPECT_LE(found.capacity_hz, 102.1);
  EXPECT_EQ(found.runs.size(), static_cast<std::size_t>(tried_n));
  EXPECT_TRUE(
      std::is_sorted(found.runs.begin(), found.runs.end(),
                     [](const load::Run& a, const load::Run& b) { return a.rate_hz < b.rate_hz; }));
  EXPECT_NEAR(found.runs.front().rate_hz, 0.2 * found.capacity_hz, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Peaks, CapacityOf, ::testing::Values(40.0, 96.0, 100.0, 140.0));

TEST(Capacity, IsNoneWhereNothingIsAnswered) {
  EXPECT_EQ(find_capacity({}, [](double rate_hz) { return run_of(rate_hz, 0); }).capacity_hz, 0);
}

TEST(Capacity, IsNotWhatThisMachineCouldNotSend) {
  load::Run run = run_of(50, 100);
  EXPECT_TRUE(is_sustained(run));
  run.summary.clock_error_ms.p50 = 500;
  EXPECT_FALSE(is_sustained(run));
}

}  // namespace
}  // namespace graspd::load
