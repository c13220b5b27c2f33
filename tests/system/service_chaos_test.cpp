#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graspd/trials/trials.hpp"

// A network that delays, chops, stalls, resets and corrupts, between real clients and real servers.
namespace graspd::trials {
namespace {

using ::testing::IsEmpty;

TEST(ServiceChaos, DelayAndChoppingChangeNothingButTime) {
  const Seen seen = through_a_slow_network(100);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceChaos, AServerWhoseNetworkStallsIsLeftForAnother) {
  const Seen seen = one_of_two_networks_stalls(50);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceChaos, ResetConnectionsFailNoRequestWhileAnotherServerLives) {
  const Seen seen = connections_reset(50, 5);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceChaos, FaultAfterFaultFailsNoRequestAndMixesUpNone) {
  const Seen seen = faults_in_turn(100, 9);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceChaos, CorruptBytesHarmNobodyBeside) {
  const CorruptedNeighbour seen = beside_a_corrupt_network(100);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
  EXPECT_GT(seen.corrupted.failed_n, 0) << "nothing was corrupted";
  EXPECT_EQ(seen.workers_lost_n, 0);
}

}  // namespace
}  // namespace graspd::trials
