#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "service_front_support.hpp"
#include "service_raw_client.hpp"

// A real front with more to do than it can, or told to stop.
namespace graspd::service {
namespace {

using client::Client;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

TEST(FrontUnderLoad, LatestFrameOfACellWins) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint}, options_of("cell", 1));
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  std::vector<std::future<Result<PlanAnswer>>> queued;
  for (int i = 0; i < 3; ++i) {
    queued.push_back(client.submit(example_frame(), example_request(), kBudget));
  }
  const auto superseded = queued[0].get();
  ASSERT_FALSE(superseded);
  EXPECT_EQ(superseded.error().code, Code::kSuperseded);
  gate.open();
  EXPECT_TRUE(running.get());
  EXPECT_TRUE(queued[1].get());
  EXPECT_TRUE(queued[2].get());
}

TEST(FrontUnderLoad, WhatIsOverItsBudgetIsAnsweredAndNotStarted) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  front.wait_ready();
  RawClient raw(front.data_endpoint);
  raw.send(good_frames(1000));
  gate.wait_for_entered(1);
  raw.send(good_frames(50, "raw", {2}));
  const Answer queued = raw.receive();
  EXPECT_EQ(queued.code, Code::kDeadlineExceeded);
  EXPECT_THAT(queued.message, HasSubstr("while it was queued"));
  const Answer running = raw.receive();
  EXPECT_EQ(running.code, Code::kDeadlineExceeded);
  EXPECT_THAT(running.message, HasSubstr("while it was computed"));
  raw.send(good_frames(0));
  EXPECT_EQ(raw.receive().code, Code::kDeadlineExceeded);
  gate.open();
  raw.send(good_frames());
  EXPECT_EQ(raw.receive().code, Code::kOk) << "and not the late result of the first";
  EXPECT_EQ(gate.entered_n(), 2);
}

TEST(FrontUnderLoad, EveryRequestOfAnOverloadIsAnswered) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(2), launcher);
  constexpr int kCells = 8;
  constexpr int kRequests = 20;
  std::vector<std::unique_ptr<Client>> clients;
  std::vector<std::future<Result<PlanAnswer>>> answers;
  for (int cell = 0; cell < kCells; ++cell) {
    clients.push_back(std::make_unique<Client>(std::vector{front.data_endpoint},
                                               options_of("cell" + std::to_string(cell), 1)));
    for (int i = 0; i < kRequests; ++i) {
      answers.push_back(clients.back()->submit(example_frame(), example_request(), kBudget));
    }
  }
  gate.wait_for_entered(2);
  gate.open();
  std::map<Code, int> count;
  for (auto& answer : answers) {
    const auto result = answer.get();
    ++count[result ? Code::kOk : result.error().code];
  }
  EXPECT_EQ(count[Code::kOk] + count[Code::kSuperseded] + count[Code::kBusy], kCells * kRequests);
  EXPECT_GE(count[Code::kOk], kCells) << "each cell's latest frame at least";
}

TEST(FrontUnderLoad, ShedsWhatItCannotAnswerInTime) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint}, options_of("cell", 1));
  auto measured = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  // The second request's end says that 100 ms have passed: so long, then, does computing take.
  const auto late = client.plan(example_frame(), example_request(), milliseconds(100));
  EXPECT_EQ(late.error().code, Code::kDeadlineExceeded);
  gate.open();
  EXPECT_TRUE(measured.get());

  gate.close();
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(2);
  Client other({front.data_endpoint}, options_of("other", 1));
  const auto busy = other.plan(example_frame(), example_request(), milliseconds(50));
  ASSERT_FALSE(busy);
  EXPECT_EQ(busy.error().code, Code::kBusy);
  EXPECT_THAT(busy.error().message, HasSubstr("retry after"));
  gate.open();
  EXPECT_TRUE(running.get());
}

TEST(FrontUnderLoad, DrainsBeforeItStops) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint}, options_of("cell", 1));
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  auto queued = client.submit(example_frame(), example_request(), kBudget);
  wait_for_health(client, [](const HealthAnswer& health) { return health.queued_n == 1; });
  front.stop();
  wait_for_health(
      client, [](const HealthAnswer& health) { return health.state == ServerState::kDraining; });
  const auto refused = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kDraining);
  gate.open();
  EXPECT_TRUE(running.get());
  EXPECT_TRUE(queued.get());
  EXPECT_EQ(front.wait_end(), "");
}

TEST(FrontUnderLoad, StopsAtOnceWhenToldTwiceAndStillAnswers) {
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint}, options_of("cell", 1));
  auto running = client.submit(example_frame(), example_request({"hang"}), kBudget);
  wait_for_health(client, [](const HealthAnswer& health) { return health.workers_busy_n == 1; });
  front.stop();
  front.stop();
  const auto answer = running.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kDraining);
  EXPECT_EQ(front.wait_end(), "");
}

TEST(FrontUnderLoad, HealthDoesNotWaitForWork) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint});
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  Client probe({front.control_endpoint});
  const auto health = probe.health(kBudget).at(0).health;
  ASSERT_TRUE(health);
  EXPECT_EQ(health->workers_busy_n, 1u);
  gate.open();
  EXPECT_TRUE(running.get());
}

}  // namespace
}  // namespace graspd::service
