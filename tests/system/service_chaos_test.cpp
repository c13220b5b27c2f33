#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"
#include "graspd/trials/trials.hpp"

// A network that delays, chops, stalls, resets and corrupts, between real clients and real servers.
namespace graspd::trials {
namespace {

TEST(ServiceChaos, DelayAndChoppingChangeNothingButTime) {
  const Seen seen = through_a_slow_network(100);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceChaos, AServerWhoseNetworkStallsIsLeftForAnother) {
  const Seen seen = one_of_two_networks_stalls(50);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceChaos, ResetConnectionsFailNoRequestWhileAnotherServerLives) {
  const Seen seen = connections_reset(50, 5);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceChaos, FaultAfterFaultFailsNoRequestAndMixesUpNone) {
  const Seen seen = faults_in_turn(100, 9);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceChaos, WhatIsAskedAgainIsNotComputedTwiceAtATime) {
  const OncePerId seen = computations_per_id(10);
  EXPECT_THAT(seen, AllServed());
  EXPECT_EQ(seen.at_once_n, 0);
  EXPECT_EQ(seen.computed_n - seen.again_n, seen.asked_n);
}

TEST(ServiceChaos, FaultAfterFaultLeavesNoMemoryAndNoDescriptorBehind) {
  const Soak seen = soak(std::chrono::seconds(12), std::chrono::milliseconds(500));
  EXPECT_THAT(seen, AllServed());
  // Each cell's place in line, buffers and the heap's own take some; a request takes 0.43 MB.
  EXPECT_LT(seen.memory_mb.back(), seen.memory_mb.at(10) + 20);
}

TEST(ServiceChaos, CorruptBytesHarmNobodyBeside) {
  const CorruptedNeighbour seen = beside_a_corrupt_network(100);
  EXPECT_THAT(seen, AllServed());
  EXPECT_GT(seen.corrupted.failed_n, 0) << "nothing was corrupted";
  EXPECT_EQ(seen.workers_lost_n, 0);
}

}  // namespace
}  // namespace graspd::trials
