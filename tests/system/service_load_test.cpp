#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"
#include "graspd/trials/trials.hpp"

// More load than there is room for: the short version of what ./run bench service measures.
namespace graspd::trials {
namespace {

using ::testing::IsEmpty;

TEST(ServiceLoad, TwiceTheCapacityIsRefusedAloudAndThePlansGoOn) {
  const OpenLoop seen = open_loop(2, 600);
  EXPECT_EQ(seen.silent_n, 0);
  EXPECT_GT(seen.failed_n, 0) << "no overload";
  EXPECT_GE(seen.goodput_share, 0.95);
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceLoad, EveryRequestIsPlannedWhereThereIsRoom) {
  const OpenLoop seen = open_loop(0.6, 150);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceLoad, AQuietCellDoesNotWaitForANoisyOne) {
  const QuietCell seen = quiet_cell(40);
  EXPECT_THAT(seen, AllServed());
  EXPECT_LE(seen.p50_ms, 60);
  EXPECT_LE(seen.worst_ms, 100);
  EXPECT_GT(seen.noisy.failed_n, 0) << "not noisy";
  EXPECT_THAT(seen.noisy.violations, IsEmpty());
}

TEST(ServiceLoad, HealthIsAnsweredWhileEveryWorkerIsBusy) {
  const std::vector<double> times_ms = health_ms_while_busy(100);
  EXPECT_LE(times_ms[50], 10);
}

class ServiceCrowd : public ::testing::TestWithParam<CrowdKind> {};

TEST_P(ServiceCrowd, AThousandIdleConnectionsFailNobody) {
  const Crowd seen = beside_a_crowd(GetParam(), 1000, 100);
  EXPECT_THAT(seen, AllServed());
  EXPECT_GE(seen.connected_n, 900u) << "no crowd";
}

INSTANTIATE_TEST_SUITE_P(Kinds, ServiceCrowd,
                         ::testing::Values(CrowdKind::kSilent, CrowdKind::kStalled),
                         [](const auto& kind) {
                           return kind.param == CrowdKind::kSilent ? "silent" : "stalled";
                         });

}  // namespace
}  // namespace graspd::trials
