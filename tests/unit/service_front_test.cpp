#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "client_support.hpp"
#include "graspd/client/client.hpp"
#include "service_raw_client.hpp"
#include "service_support.hpp"

// A real front with real sockets, asked through the real client library.
namespace graspd::service {
namespace {

using client::Client;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr seconds kBudget{20};

ProcessLauncher processes() { return {GRASPD_SCRIPTED_WORKER, {"scripted_worker"}}; }
ThreadLauncher threads(PlanHandler handler = scripted_plan) {
  return {std::move(handler), kScriptedServer};
}

client::ClientOptions options_of(const std::string& cell, std::uint32_t max_attempts_n = 3) {
  client::ClientOptions options;
  options.cell = cell;
  options.dispatch.max_attempts_n = max_attempts_n;
  return options;
}

/// Asks until the answer is as wanted. Health never waits for work, so this is quick.
void wait_for_health(Client& client, const std::function<bool(const HealthAnswer&)>& wanted) {
  while (true) {
    const auto health = client.health(kBudget).at(0).health;
    ASSERT_TRUE(health) << health.error().message;
    if (wanted(*health)) return;
  }
}

TEST(Front, AnswersHealthOnBothSockets) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(2), launcher);
  front.wait_ready();
  Client client({front.data_endpoint, front.control_endpoint});
  for (const client::ServerHealth& server : client.health(kBudget)) {
    ASSERT_TRUE(server.health) << server.health.error().message;
    EXPECT_EQ(server.health->state, ServerState::kReady);
    EXPECT_EQ(server.health->workers_n, 2u);
    EXPECT_EQ(server.health->part_ids, kScriptedParts);
    EXPECT_EQ(server.health->server.catalogue_hash, "catalogue");
    EXPECT_GE(server.health->uptime_s, 0);
  }
}

TEST(Front, PlansAndSaysHowLongItTookAndWhoAnswered) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint});
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->outcome, Outcome::kPlanned);
  EXPECT_EQ(answer->funnel.readings_n, 16u * 12 - 1);
  EXPECT_EQ(answer->server.build, "scripted");
  ASSERT_EQ(answer->timings.size(), 3u);
  EXPECT_EQ(answer->timings[0].stage, "queue");
  EXPECT_EQ(answer->timings[1].stage, "decode");
  EXPECT_EQ(answer->timings[2].stage, "script");
  EXPECT_GT(answer->timings[0].duration_ns, 0);
  EXPECT_GT(answer->timings[1].duration_ns, 0);
}

TEST(Front, ServesCellsWithDifferentCamerasAndPartsAtTheSameTime) {
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(2), launcher);
  std::atomic<int> right = 0;
  const auto cell = [&](int width_px, int height_px, const std::string& part) {
    Client client({front.data_endpoint}, options_of(part));
    for (int i = 0; i < 50; ++i) {
      const auto answer =
          client.plan(example_frame(width_px, height_px), example_request({part}), kBudget);
      ASSERT_TRUE(answer) << answer.error().message;
      ASSERT_EQ(answer->funnel.pixels_n, static_cast<std::uint32_t>(width_px * height_px));
      ASSERT_EQ(answer->objects.at(0).part_id, part);
      ++right;
    }
  };
  std::thread kinect(cell, 512, 424, "echo");
  std::thread other(cell, 640, 480, "other");
  kinect.join();
  other.join();
  EXPECT_EQ(right, 100);
}

TEST(Front, AWorkerThatDiesCostsItsRequestAlone) {
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint});
  for (int i = 0; i < 3; ++i) {
    const auto lost = client.plan(example_frame(), example_request({"crash"}), kBudget);
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, Code::kInternal);
    EXPECT_THAT(lost.error().message, HasSubstr("signal 9"));
    EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  }
}

TEST(Front, AWorkerThatHangsIsReplaced) {
  ServerConfig config = scripted_config(1);
  config.worker_time_limit_ms = 200;
  ProcessLauncher launcher = processes();
  RunningFront front(config, launcher);
  Client client({front.data_endpoint});
  const auto hung = client.plan(example_frame(), example_request({"hang"}), kBudget);
  ASSERT_FALSE(hung);
  EXPECT_EQ(hung.error().code, Code::kInternal);
  EXPECT_THAT(hung.error().message, HasSubstr("worker_time_limit_ms"));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
}

TEST(Front, APlannersExceptionIsAnAnswer) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint});
  const auto answer = client.plan(example_frame(), example_request({"throw"}), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kInternal);
  EXPECT_THAT(answer.error().message, HasSubstr("the script says so"));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
}

TEST(Front, UnknownPartsAreRefusedWithTheKnownOnes) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint});
  const auto answer = client.plan(example_frame(), example_request({"echo", "gizmo"}), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kUnknownPart);
  EXPECT_THAT(answer.error().message, HasSubstr("'gizmo'"));
  EXPECT_THAT(answer.error().message, HasSubstr("crash, echo"));
}

TEST(Front, LatestFrameOfACellWins) {
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

TEST(Front, WhatIsOverItsBudgetIsAnsweredAndNotStarted) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher);
  front.wait_ready();
  RawClient raw(front.data_endpoint);
  raw.send(good_frames(1000));
  gate.wait_for_entered(1);
  raw.send(good_frames(50));
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

TEST(Front, EveryRequestOfAnOverloadIsAnswered) {
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

TEST(Front, ShedsWhatItCannotAnswerInTime) {
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

TEST(Front, DrainsBeforeItStops) {
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

TEST(Front, StopsAtOnceWhenToldTwiceAndStillAnswers) {
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

TEST(Front, HealthDoesNotWaitForWork) {
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

TEST(Front, TheControlEndpointTakesNoPlans) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.control_endpoint});
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kInvalidArgument);
  EXPECT_THAT(answer.error().message, HasSubstr("data endpoint"));
}

TEST(Front, AnswersThatAreTooLargeLoseWhatWasAskedOnTop) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint});
  const auto large = client.plan(example_frame(), example_request({"large"}), kBudget);
  ASSERT_TRUE(large) << large.error().message;
  EXPECT_TRUE(large->rejected_grasps.empty());
  EXPECT_THAT(large->warnings, ElementsAre(HasSubstr("rejected grasps")));
  const auto larger = client.plan(example_frame(), example_request({"larger"}), kBudget);
  ASSERT_TRUE(larger) << larger.error().message;
  EXPECT_TRUE(larger->objects.at(0).outline_px.empty());
  const auto largest = client.plan(example_frame(), example_request({"largest"}), kBudget);
  ASSERT_FALSE(largest);
  EXPECT_EQ(largest.error().code, Code::kInternal);
  EXPECT_THAT(largest.error().message, HasSubstr("bytes"));
}

TEST(Front, LogsOneLinePerRequest) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  Client client({front.data_endpoint}, options_of("cell_7"));
  ASSERT_TRUE(client.plan(example_frame(), example_request({"echo", "other"}), kBudget));
  const auto log = front.log();
  const auto line = std::find_if(log.begin(), log.end(), [](const std::string& text) {
    return text.find("code=OK") != std::string::npos;
  });
  ASSERT_NE(line, log.end());
  EXPECT_THAT(*line, ::testing::MatchesRegex("id=[0-9a-f]+ attempt=1 cell=cell_7 parts=echo,other "
                                             "code=OK outcome=PLANNED objects=2 grasps=0 "
                                             "queue_ms=[0-9.]+ total_ms=[0-9.]+"));
}

TEST(Front, AnEndpointInUseIsNamedWithWhatToDo) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(0), launcher);
  ServerConfig config = scripted_config(0);
  config.data_endpoint = front.data_endpoint;
  try {
    RunningFront second(config, launcher);
    FAIL() << "it listens where another server does";
  } catch (const CannotListen& error) {
    EXPECT_THAT(error.what(), HasSubstr(front.data_endpoint));
    EXPECT_THAT(error.what(), HasSubstr("in use"));
  }
  config = scripted_config(0);
  config.control_endpoint = "tcp://203.0.113.9:5556";  // nobody's (RFC 5737)
  EXPECT_THROW(RunningFront(config, launcher), CannotListen);
}

TEST(Front, WorkersThatNeverGetReadyEndTheServer) {
  ProcessLauncher nothing("/nowhere/grasp_server", {"grasp_server"});
  RunningFront front(scripted_config(1), nothing);
  EXPECT_THAT(front.wait_end(), HasSubstr("exit code 127"));
}

TEST(Front, WorkersWithOtherPartsMayNotAnswer) {
  ThreadLauncher launcher(scripted_plan, {"scripted", "other catalogue", "config"});
  RunningFront front(scripted_config(1), launcher);
  EXPECT_THAT(front.wait_end(), HasSubstr("parts on disk have changed"));
}

}  // namespace
}  // namespace graspd::service
