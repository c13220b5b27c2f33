#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"
#include "graspd/trials/trials.hpp"

// Two servers and their clients on machines of their own, with keys, and a bad cable to one.
namespace graspd::trials {
namespace {

using std::chrono::seconds;
class BadLink : public ::testing::TestWithParam<LinkFault> {};

TEST_P(BadLink, ToOneOfTwoServersFailsNoRequest) {
  const std::string why_not = why_no_namespaces();
  if (!why_not.empty()) GTEST_SKIP() << why_not;
  const Seen seen = one_of_two_links_is_bad(GetParam(), seconds(5));
  EXPECT_THAT(seen, AllServed());
}

INSTANTIATE_TEST_SUITE_P(ServiceNamespaces, BadLink,
                         ::testing::Values(LinkFault::kPartition, LinkFault::kLoss5,
                                           LinkFault::kLoss30, LinkFault::k20Mbit),
                         [](const auto& fault) { return std::string(name_of(fault.param)); });

TEST(ServiceNamespaces, WithLossOnBothLinksEveryRequestEndsWithinItsBudget) {
  const std::string why_not = why_no_namespaces();
  if (!why_not.empty()) GTEST_SKIP() << why_not;
  const Seen seen = both_links_are_bad(LinkFault::kLoss5, seconds(5));
  EXPECT_THAT(seen.violations, ::testing::IsEmpty()) << seen.ended;
  EXPECT_GT(seen.asked_n, seen.failed_n);
}

}  // namespace
}  // namespace graspd::trials
