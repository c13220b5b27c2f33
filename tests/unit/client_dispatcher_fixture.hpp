#pragma once

#include <gtest/gtest.h>

#include "graspd/client/dispatcher.hpp"

/// A dispatcher of two servers that is told what time it is.
namespace graspd::client::dispatching {

const TimePoint kStart{std::chrono::seconds(1000)};
const TimePoint kDeadline = kStart + std::chrono::seconds(10);

inline RequestId id(int number) {
  RequestId id{};
  id[0] = static_cast<std::uint8_t>(number);
  return id;
}

inline Answer answer(int number, Code code = Code::kOk, std::uint32_t retry_after_ms = 0) {
  Answer answer;
  answer.id = id(number);
  answer.code = code;
  answer.message = code == Code::kOk ? "" : "because";
  answer.retry_after_ms = retry_after_ms;
  return answer;
}

class DispatcherTest : public ::testing::Test {
 protected:
  /// The one attempt that is due now.
  Dispatcher::Attempt attempt(TimePoint now) {
    const auto step = dispatcher_.step(now);
    EXPECT_EQ(step.attempts.size(), 1u);
    EXPECT_TRUE(step.failed.empty());
    return step.attempts.empty() ? Dispatcher::Attempt{} : step.attempts[0];
  }
  Error failure(TimePoint now) {
    const auto step = dispatcher_.step(now);
    EXPECT_TRUE(step.attempts.empty());
    EXPECT_EQ(step.failed.size(), 1u);
    return step.failed.empty() ? Error{} : step.failed[0].error;
  }
  void expect_nothing(TimePoint now) {
    const auto step = dispatcher_.step(now);
    EXPECT_TRUE(step.attempts.empty() && step.failed.empty());
  }

  DispatchOptions options_;
  Dispatcher dispatcher_{{"tcp://a:1", "tcp://b:1"}, options_, 1};
};

}  // namespace graspd::client::dispatching
