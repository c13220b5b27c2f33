#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/load/summary.hpp"

namespace graspd::load {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pair;

Sample sample(std::size_t cell, double planned_s, double ended_ms, Code code = Code::kOk) {
  Sample made;
  made.cell = cell;
  made.planned_s = planned_s;
  made.code = code;
  made.sent_ms = 0.1;
  made.ended_ms = ended_ms;
  return made;
}

TEST(Quantiles, AreValuesThatTheShareIsNotAbove) {
  std::vector<double> values;
  for (int i = 1000; i > 0; --i) values.push_back(i);
  const Quantiles quantiles = quantiles_of(values);
  EXPECT_EQ(quantiles.p50, 500);
  EXPECT_EQ(quantiles.p90, 900);
  EXPECT_EQ(quantiles.p99, 990);
  EXPECT_EQ(quantiles.p999, 999);
  EXPECT_EQ(quantiles.most, 1000);
  EXPECT_EQ(quantiles_of({}).p99, 0);
  EXPECT_EQ(quantiles_of({7}).p50, 7);
}

TEST(Jain, IsOneWhereAllHaveTheSameAndOneOverNWhereOneHasAll) {
  EXPECT_DOUBLE_EQ(jain({3, 3, 3, 3}), 1);
  EXPECT_DOUBLE_EQ(jain({5, 0, 0, 0}), 0.25);
  EXPECT_DOUBLE_EQ(jain({1, 2}), 0.9);
  EXPECT_DOUBLE_EQ(jain({0, 0}), 1);
}

TEST(Summary, LatencyIsOfWhatWasPlannedAndGoodputOfWhatCame) {
  // A queue grows: of two requests planned in the second, one is answered after it, and one of
  // the second before is answered in it.
  const std::vector<Sample> samples{sample(0, 0.5, 700), sample(0, 1.2, 100), sample(1, 1.9, 900),
                                    sample(1, 1.3, 1, Code::kBusy)};
  const Summary seen = summarise(samples, 1, 2, 2);
  EXPECT_EQ(seen.asked_n, 3u);
  EXPECT_EQ(seen.ok_n, 2u);
  EXPECT_DOUBLE_EQ(seen.goodput_hz, 2);
  EXPECT_EQ(seen.latency_ms.most, 900);
  EXPECT_THAT(seen.ended_n, ElementsAre(Pair(Code::kOk, 2u), Pair(Code::kBusy, 1u)));
  EXPECT_DOUBLE_EQ(seen.cells[0].goodput_hz, 2);
  EXPECT_DOUBLE_EQ(seen.cells[1].goodput_hz, 0);
  EXPECT_DOUBLE_EQ(seen.jain, 0.5);
}

TEST(Summary, SplitsAllOfTheTimeBetweenThePlannedInstantAndTheEnd) {
  Sample made = sample(0, 0, 100);
  made.sent_ms = 5;
  made.timings = {{"queue", 20'000'000}, {"decode", 1'000'000}, {"registration", 60'000'000}};
  const Summary seen = summarise({made}, 0, 1, 1);
  EXPECT_THAT(seen.split_ms,
              ElementsAre(Pair("send", 5), Pair("transport", DoubleNear(14, 1e-9)),
                          Pair("queue", 20), Pair("decode", 1), Pair("registration", 60)));
}

TEST(Summary, SaysWhereThisMachineCouldNotSendWhatWasPlanned) {
  std::vector<Sample> samples;
  for (int i = 0; i < 100; ++i) {
    samples.push_back(sample(0, i / 100.0, 2000));
    samples.back().handed_over_ms = 10.0 * i;  // half as fast as planned
    samples.back().sent_ms = 10.0 * i;
  }
  const Summary seen = summarise(samples, 0, 1, 1);
  EXPECT_TRUE(is_late(seen));
  EXPECT_NEAR(seen.asked_hz, 100, 1e-9);
  EXPECT_NEAR(seen.sent_hz, 50, 1);
  EXPECT_FALSE(is_late(summarise({sample(0, 0, 1)}, 0, 1, 1)));
}

}  // namespace
}  // namespace graspd::load
