#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"
#include "graspd/trials/trials.hpp"

// Servers and workers that die or are told to stop under load, as clients see it: the short version
// of what ./run bench service measures.
namespace graspd::trials {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;

TEST(ServiceDeath, OneOfTwoServersKilledFailsNoRequest) {
  const Seen seen = kill_one_of_two_servers(200);
  EXPECT_GE(seen.asked_n, 400);
  EXPECT_THAT(seen, AllServed());
}

TEST(ServiceDeath, AKilledWorkerCostsTheOneRequestItHeld) {
  constexpr int kKilled = 5;
  const Seen seen = kill_workers(50, kKilled);
  EXPECT_LE(seen.failed_n, kKilled) << seen.ended;
  EXPECT_THAT(seen.violations, IsEmpty());
}

TEST(ServiceDeath, ARollingRestartFailsNoRequest) {
  const RollingRestart seen = rolling_restart(100);
  EXPECT_EQ(seen.failed_n, 0) << seen.ended;
  EXPECT_THAT(seen.exit_codes, Each(0));
  EXPECT_LE(seen.longest_stop_s, 12);
  EXPECT_THAT(seen.violations, IsEmpty());
}

}  // namespace
}  // namespace graspd::trials
