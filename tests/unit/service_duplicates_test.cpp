#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service_front_support.hpp"
#include "service_raw_client.hpp"

// A request that comes again: while it is computed, and after it has cost workers their life.
namespace graspd::service {
namespace {

using client::Client;
using ::testing::HasSubstr;

TEST(Duplicates, ASecondMessageWithTheSameIdWaitsForTheFirstsAnswer) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(2), launcher);
  RawClient first(front.data_endpoint);
  RawClient after_reconnecting(front.data_endpoint);
  first.send(good_frames());
  gate.wait_for_entered(1);
  after_reconnecting.send(good_frames());
  // Messages of one connection are read in order: the duplicate has been read when this is refused.
  after_reconnecting.send({"not an envelope"});
  EXPECT_EQ(after_reconnecting.receive().code, Code::kInvalidArgument);
  gate.open();
  for (RawClient* client : {&first, &after_reconnecting}) {
    const Answer answer = client->receive();
    EXPECT_EQ(answer.id, kRawId);
    EXPECT_EQ(answer.code, Code::kOk);
  }
  EXPECT_EQ(gate.entered_n(), 1) << "computed twice";
}

TEST(Duplicates, AnotherRequestUnderTheSameIdIsRefused) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(2), launcher);
  RawClient first(front.data_endpoint);
  RawClient other(front.data_endpoint);
  first.send(good_frames());
  gate.wait_for_entered(1);
  other.send(good_frames(20'000, "another cell"));
  const Answer refused = other.receive();
  EXPECT_EQ(refused.code, Code::kInvalidArgument);
  EXPECT_THAT(refused.message, HasSubstr("id: another request"));
  gate.open();
  EXPECT_EQ(first.receive().code, Code::kOk);
  EXPECT_EQ(gate.entered_n(), 1);
}

TEST(Duplicates, MessagesOfOneRequestDoNotPileUp) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  RawClient client(front.data_endpoint);
  constexpr int kWaiting = 16;
  for (int i = 0; i <= kWaiting; ++i) client.send(good_frames());
  EXPECT_EQ(client.receive().code, Code::kInvalidArgument);
  gate.open();
  for (int i = 0; i < kWaiting; ++i) EXPECT_EQ(client.receive().code, Code::kOk);
  EXPECT_EQ(gate.entered_n(), 1);
}

TEST(Duplicates, AnIdThatHasBeenAnsweredMayComeAgain) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher);
  RawClient client(front.data_endpoint);
  for (int i = 0; i < 3; ++i) {
    client.send(good_frames());
    EXPECT_EQ(client.receive().code, Code::kOk);
  }
}

TEST(Poison, AFrameThatKilledTwoWorkersIsNotTriedAgain) {
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint});
  const auto crash = [&](int height_px) {
    return client.plan(example_frame(16, height_px), example_request({"crash"}), kBudget);
  };
  EXPECT_EQ(crash(12).error().code, Code::kInternal);
  EXPECT_EQ(crash(13).error().code, Code::kInternal) << "another frame is its own suspect";
  EXPECT_EQ(crash(12).error().code, Code::kInternal);
  for (int i = 0; i < 5; ++i) {
    const auto rejected = crash(12);
    ASSERT_FALSE(rejected);
    EXPECT_EQ(rejected.error().code, Code::kRejectedPoison);
    EXPECT_THAT(rejected.error().message, HasSubstr("2 workers were lost"));
  }
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  Client other({front.data_endpoint}, options_of("other cell"));
  EXPECT_EQ(other.plan(example_frame(), example_request({"crash"}), kBudget).error().code,
            Code::kInternal)
      << "no cell is judged by another's deaths";
  const auto health = client.health(kBudget).at(0).health;
  ASSERT_TRUE(health);
  EXPECT_EQ(health->workers_lost_n, 4u);
}

TEST(Poison, AFrameThatHangsTwoWorkersIsNotTriedAgain) {
  ServerConfig config = scripted_config(1);
  config.worker_time_limit_ms = 100;
  ProcessLauncher launcher = processes();
  RunningFront front(config, launcher);
  Client client({front.data_endpoint});
  for (const Code code : {Code::kInternal, Code::kInternal, Code::kRejectedPoison}) {
    const auto hung = client.plan(example_frame(), example_request({"hang"}), kBudget);
    ASSERT_FALSE(hung);
    EXPECT_EQ(hung.error().code, code);
  }
}

}  // namespace
}  // namespace graspd::service
