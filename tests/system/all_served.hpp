#pragma once

#include <gmock/gmock.h>

namespace graspd::trials {

/// Of what a trial has seen: no request failed, and the history of messages breaks no rule.
// Named as Google Test names its own matchers. NOLINTNEXTLINE(readability-identifier-naming)
MATCHER(AllServed, "") {
  *result_listener << arg.failed_n << " failed: " << arg.ended
                   << "; broken rules: " << ::testing::PrintToString(arg.violations);
  return arg.failed_n == 0 && arg.violations.empty();
}

}  // namespace graspd::trials
