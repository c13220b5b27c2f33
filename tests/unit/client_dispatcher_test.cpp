#include <gmock/gmock.h>

#include <algorithm>

#include "client_dispatcher_fixture.hpp"

namespace graspd::client::dispatching {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

TEST_F(DispatcherTest, WaitsForAConnectionThenSaysWhatToCheck) {
  dispatcher_.add(id(1), kStart, kDeadline);
  const auto step = dispatcher_.step(kStart);
  EXPECT_TRUE(step.attempts.empty() && step.failed.empty());
  EXPECT_EQ(step.wake, kStart + options_.connect_timeout);
  const Error error = failure(kStart + options_.connect_timeout);
  EXPECT_EQ(error.code, Code::kUnavailable);
  EXPECT_THAT(error.message, HasSubstr("tcp://a:1, tcp://b:1"));
  EXPECT_THAT(error.message, HasSubstr("grasp_server"));
}

TEST_F(DispatcherTest, SendsAsSoonAsAServerIsThere) {
  dispatcher_.add(id(1), kStart, kDeadline);
  expect_nothing(kStart);
  dispatcher_.connected(1);
  const auto sent = attempt(kStart + milliseconds(100));
  EXPECT_EQ(sent.server, 1u);
  EXPECT_EQ(sent.number, 1u);
  EXPECT_EQ(sent.budget, milliseconds(9900)) << "nobody else to ask, so all that is left";
  const auto result = dispatcher_.answered(1, answer(1), kStart + milliseconds(200));
  ASSERT_TRUE(result);
  EXPECT_TRUE(*result);
  EXPECT_FALSE(dispatcher_.answered(1, answer(1), kStart)) << "a second answer is nobody's";
}

TEST_F(DispatcherTest, PicksTheServerWithFewestCallsInFlight) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  std::vector<std::vector<int>> in_flight(2);
  for (int call = 1; call <= 8; ++call) {
    dispatcher_.add(id(call), kStart, kDeadline);
    in_flight[attempt(kStart).server].push_back(call);
  }
  ASSERT_EQ(in_flight[0].size(), 4u);
  for (int i = 0; i < 2; ++i) dispatcher_.answered(0, answer(in_flight[0][i]), kStart);
  for (const int call : {9, 10}) {
    dispatcher_.add(id(call), kStart, kDeadline);
    EXPECT_EQ(attempt(kStart).server, 0u);
  }
}

TEST_F(DispatcherTest, OneCallAfterTheOtherUsesAllServers) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  std::vector<int> asked_n(2);
  for (int call = 1; call <= 10; ++call) {
    dispatcher_.add(id(call), kStart, kDeadline);
    const std::size_t server = attempt(kStart).server;
    ++asked_n[server];
    dispatcher_.answered(server, answer(call), kStart);
  }
  EXPECT_EQ(asked_n, (std::vector<int>{5, 5}));
}

TEST(Dispatcher, ClientsDoNotAllStartWithTheSameServer) {
  std::vector<int> first_n(2);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Dispatcher dispatcher({"tcp://a:1", "tcp://b:1"}, {}, seed);
    dispatcher.connected(0);
    dispatcher.connected(1);
    dispatcher.add(id(1), kStart, kDeadline);
    ++first_n[dispatcher.step(kStart).attempts.at(0).server];
  }
  EXPECT_GT(first_n[0], 5);
  EXPECT_GT(first_n[1], 5);
}

class SilentServer : public DispatcherTest {
 protected:
  SilentServer() {
    dispatcher_.connected(0);
    dispatcher_.connected(1);
    dispatcher_.add(id(1), kStart, kDeadline);
    silent_ = attempt(kStart).server;
    dispatcher_.answered(attempt(now_).server, answer(1), now_);
  }
  std::size_t server_of(int call, TimePoint now) {
    dispatcher_.add(id(call), now, now + seconds(10));
    return attempt(now).server;
  }
  TimePoint now_ = kStart + options_.attempt_timeout;
  std::size_t silent_ = 0;
};

TEST_F(SilentServer, IsLeftAlone) {
  for (int call = 2; call < 10; ++call) EXPECT_NE(server_of(call, now_), silent_);
}

TEST_F(SilentServer, IsTriedByOneCallAfterATime) {
  const TimePoint later = now_ + seconds(2);
  std::vector<std::size_t> servers;
  for (int call = 2; call < 6; ++call) servers.push_back(server_of(call, later));
  EXPECT_EQ(std::count(servers.begin(), servers.end(), silent_), 1);
}

TEST_F(SilentServer, IsOneOfAllAgainWhenItAnswers) {
  dispatcher_.answered(silent_, answer(1), now_);  // late, of a call that has ended
  std::vector<std::size_t> servers;
  for (int call = 2; call < 6; ++call) servers.push_back(server_of(call, now_));
  EXPECT_EQ(std::count(servers.begin(), servers.end(), silent_), 2);
}

TEST_F(SilentServer, IsAskedWhereThereIsNobodyElse) {
  dispatcher_.disconnected(1 - silent_, now_);
  EXPECT_EQ(server_of(2, now_), silent_);
}

TEST_F(SilentServer, IsLeftAloneForLongerWithEachSilence) {
  // The call that tries it again loses its time too.
  TimePoint now = now_ + seconds(2);
  EXPECT_EQ(server_of(2, now), silent_);
  now += options_.attempt_timeout;
  dispatcher_.answered(attempt(now).server, answer(2), now);
  EXPECT_NE(server_of(3, now + seconds(3)), silent_);
  EXPECT_EQ(server_of(4, now + seconds(4)), silent_);
}

TEST_F(DispatcherTest, SendsInTheOrderOfTheCalls) {
  dispatcher_.connected(0);
  std::vector<RequestId> ids;
  for (const int call : {9, 3, 7, 1}) {
    ids.push_back(id(call));
    dispatcher_.add(id(call), kStart, kDeadline);
  }
  std::vector<RequestId> sent;
  for (const auto& attempt : dispatcher_.step(kStart).attempts) sent.push_back(attempt.id);
  EXPECT_EQ(sent, ids);
}

TEST_F(DispatcherTest, AServerThatComesLaterTakesOverFromASilentOne) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  attempt(kStart);
  const TimePoint later = kStart + 2 * options_.attempt_timeout;
  expect_nothing(later);
  dispatcher_.connected(1);
  EXPECT_EQ(attempt(later).server, 1u);
}

TEST_F(DispatcherTest, AnAttemptWithoutAnswerGoesToTheOtherServer) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  dispatcher_.add(id(1), kStart, kDeadline);
  const auto first = attempt(kStart);
  EXPECT_EQ(first.budget, options_.attempt_timeout);
  expect_nothing(kStart + options_.attempt_timeout - milliseconds(1));
  const auto second = attempt(kStart + options_.attempt_timeout);
  EXPECT_NE(second.server, first.server);
  EXPECT_EQ(second.number, 2u);
}

TEST_F(DispatcherTest, ALateAnswerIsStillAnAnswerButALateRefusalIsNot) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  for (const int call : {1, 2}) dispatcher_.add(id(call), kStart, kDeadline);
  const auto first = dispatcher_.step(kStart).attempts;
  const TimePoint later = kStart + options_.attempt_timeout;
  ASSERT_EQ(dispatcher_.step(later).attempts.size(), 2u);
  EXPECT_FALSE(dispatcher_.answered(first[0].server, answer(1, Code::kInternal), later));
  EXPECT_TRUE(dispatcher_.answered(first[1].server, answer(2), later));
}

TEST_F(DispatcherTest, StopsAfterThreeAttempts) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  dispatcher_.add(id(1), kStart, kStart + seconds(100));
  TimePoint now = kStart;
  int attempts = 0;
  Error error;
  for (int i = 0; i < 1000 && error.message.empty(); ++i, now += milliseconds(100)) {
    const auto step = dispatcher_.step(now);
    attempts += static_cast<int>(step.attempts.size());
    if (!step.failed.empty()) error = step.failed[0].error;
  }
  EXPECT_EQ(attempts, 3);
  EXPECT_EQ(error.code, Code::kDeadlineExceeded);
  EXPECT_THAT(error.message, HasSubstr("3 attempts"));
}

TEST_F(DispatcherTest, BusyGoesToTheOtherServerAtOnce) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  dispatcher_.add(id(1), kStart, kDeadline);
  const auto first = attempt(kStart);
  EXPECT_FALSE(dispatcher_.answered(first.server, answer(1, Code::kBusy, 500), kStart));
  const auto second = attempt(kStart);
  EXPECT_NE(second.server, first.server);
  dispatcher_.add(id(2), kStart, kDeadline);
  EXPECT_EQ(attempt(kStart).server, second.server) << "the busy one asked to be left alone";
}

TEST_F(DispatcherTest, TheOnlyServerIsAskedAgainWhenItSaid) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  attempt(kStart);
  dispatcher_.answered(0, answer(1, Code::kBusy, 700), kStart);
  const auto step = dispatcher_.step(kStart);
  EXPECT_TRUE(step.attempts.empty());
  EXPECT_EQ(step.wake, kStart + milliseconds(700));
  EXPECT_EQ(attempt(kStart + milliseconds(700)).number, 2u);
}

TEST_F(DispatcherTest, BusyForLongerThanTheBudgetFailsAtOnce) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kStart + milliseconds(500));
  attempt(kStart);
  dispatcher_.answered(0, answer(1, Code::kBusy, 700), kStart);
  EXPECT_EQ(failure(kStart).code, Code::kBusy);
}

TEST_F(DispatcherTest, RefusalsThatNoServerWouldTakeBackEndTheCall) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  int call = 1;
  for (const Code code : {Code::kInvalidArgument, Code::kUnknownPart, Code::kSuperseded,
                          Code::kDeadlineExceeded, Code::kInternal, Code::kRejectedPoison}) {
    dispatcher_.add(id(call), kStart, kDeadline);
    const auto sent = attempt(kStart);
    const auto result = dispatcher_.answered(sent.server, answer(call, code), kStart);
    ASSERT_TRUE(result) << name_of(code);
    ASSERT_FALSE(*result);
    EXPECT_EQ(result->error().code, code);
    EXPECT_EQ(result->error().message, "because");
    ++call;
  }
}

TEST_F(DispatcherTest, ALostConnectionMovesItsCallsAtOnce) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  dispatcher_.add(id(1), kStart, kDeadline);
  const auto first = attempt(kStart);
  dispatcher_.disconnected(first.server, kStart + milliseconds(5));
  EXPECT_NE(attempt(kStart + milliseconds(5)).server, first.server);
}

TEST_F(DispatcherTest, ALostConnectionToTheOnlyServerNamesIt) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  attempt(kStart);
  dispatcher_.disconnected(0, kStart);
  expect_nothing(kStart);
  const Error error = failure(kStart + options_.connect_timeout);
  EXPECT_EQ(error.code, Code::kUnavailable);
  EXPECT_THAT(error.message, HasSubstr("tcp://a:1"));
}

TEST_F(DispatcherTest, RetriesAreATenthOfTheCallsInTheLongRun) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  TimePoint now = kStart;
  int attempts = 0;
  constexpr int kCalls = 1000;
  for (int call = 0; call < kCalls; ++call) {
    RequestId number{};
    number[0] = static_cast<std::uint8_t>(call & 0xff);
    number[1] = static_cast<std::uint8_t>(call >> 8);
    dispatcher_.add(number, now, now + seconds(5));
    // Both servers are draining, always.
    for (bool over = false; !over;) {
      const auto step = dispatcher_.step(now);
      over = !step.failed.empty();
      for (const auto& sent : step.attempts) {
        ++attempts;
        Answer draining = answer(0, Code::kDraining);
        draining.id = number;
        dispatcher_.answered(sent.server, draining, now);
      }
      now += milliseconds(200);
    }
  }
  EXPECT_GT(attempts, kCalls + kCalls / 20);
  EXPECT_LT(attempts, kCalls + kCalls / 10 + 20);
}

TEST_F(DispatcherTest, LostConnectionsFailNoCallHoweverManyThereAre) {
  dispatcher_.connected(0);
  TimePoint now = kStart;
  for (int call = 0; call < 100; ++call) {
    dispatcher_.add(id(call), now, now + seconds(5));
    EXPECT_EQ(attempt(now).number, 1u);
    dispatcher_.disconnected(0, now);
    now += milliseconds(200);
    dispatcher_.connected(0);
    EXPECT_EQ(attempt(now).number, 2u) << call;
    EXPECT_TRUE(dispatcher_.answered(0, answer(call), now));
  }
}

TEST_F(DispatcherTest, AnAttemptThatWasNotSentIsNone) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  attempt(kStart);
  dispatcher_.not_sent(id(1), kStart);
  const auto step = dispatcher_.step(kStart);
  EXPECT_TRUE(step.attempts.empty());
  EXPECT_EQ(attempt(step.wake).number, 1u);
}

TEST_F(DispatcherTest, ARetryThatWasNotSentIsTriedUntilItIs) {
  dispatcher_.connected(0);
  dispatcher_.add(id(1), kStart, kDeadline);
  attempt(kStart);
  dispatcher_.answered(0, answer(1, Code::kBusy, 1), kStart);
  TimePoint now = dispatcher_.step(kStart).wake;
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(attempt(now).number, 2u) << i;
    dispatcher_.not_sent(id(1), now);
    now = dispatcher_.step(now).wake;
  }
  EXPECT_EQ(attempt(now).number, 2u);
}

TEST_F(DispatcherTest, HealthAsksOneServerOnce) {
  dispatcher_.connected(0);
  dispatcher_.connected(1);
  dispatcher_.add(id(1), kStart, kStart + seconds(2), 1);
  EXPECT_EQ(attempt(kStart).server, 1u);
  EXPECT_EQ(failure(kStart + seconds(2)).code, Code::kDeadlineExceeded);
  dispatcher_.disconnected(1, kStart);
  dispatcher_.add(id(2), kStart, kStart + seconds(2), 1);
  expect_nothing(kStart);
  EXPECT_THAT(failure(kStart + options_.connect_timeout).message,
              ::testing::AllOf(HasSubstr("tcp://b:1"), ::testing::Not(HasSubstr("tcp://a:1"))));
}

}  // namespace
}  // namespace graspd::client::dispatching
