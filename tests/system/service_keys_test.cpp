#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "all_served.hpp"
#include "graspd/trials/trials.hpp"

// Keys under load: the short version of what ./run bench service measures.
namespace graspd::trials {
namespace {

using ::testing::StartsWith;

TEST(ServiceKeys, ARevokedKeyEndsItsOwnCellsRequestsAndNoOthers) {
  const RevokedKey seen = revoke_a_key(100);
  EXPECT_THAT(seen, AllServed());
  EXPECT_EQ(seen.ok_before_n, 100);
  EXPECT_EQ(seen.ok_after_n, 0);
  EXPECT_EQ(seen.refusal,
            "UNAUTHENTICATED: this key is not allowed any more; ask who runs the server for "
            "another one");
  EXPECT_THAT(seen.newcomer_refusal, StartsWith("UNAUTHENTICATED: "));
}

}  // namespace
}  // namespace graspd::trials
