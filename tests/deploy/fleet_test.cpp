#include "graspd/trials/fleet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"

// Fleets of deploy/: what ./run bench fleet measures, short.
namespace graspd::trials {
namespace {

using ::testing::Each;
using ::testing::Gt;

TEST(Fleet, AnotherServerKeyFailsNoRequest) {
  EXPECT_THAT(change_the_server_key(100), AllServed());
}

TEST(Fleet, AServerKilledBehindHaproxyFailsNoRequest) {
  if (const std::string why_not = why_no_haproxy(); !why_not.empty()) GTEST_SKIP() << why_not;
  const BehindHaproxy seen = kill_one_server_behind_haproxy(200);
  EXPECT_THAT(seen, AllServed());
  EXPECT_THAT(seen.answers_n, Each(Gt(0))) << "both had clients";
}

TEST(Fleet, ALostSlurmNodeFailsNoRequestAndItsServerMoves) {
  if (const std::string why_not = why_no_slurm(); !why_not.empty()) GTEST_SKIP() << why_not;
  EXPECT_THAT(lose_a_slurm_node(200), AllServed());
}

}  // namespace
}  // namespace graspd::trials
