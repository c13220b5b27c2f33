#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "service_front_support.hpp"

// A real front with real sockets, asked through the real client library.
namespace graspd::service {
namespace {

using client::Client;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST(Front, TellsThePlannerWhenItsTimeIsUp) {
  std::promise<TimePoint> told;
  ThreadLauncher launcher =
      threads([&](const DepthFrame&, const PlanRequest&, TimePoint deadline) -> Result<PlanAnswer> {
        told.set_value(deadline);
        return fail(Code::kDeadlineExceeded, "after preprocess");
      });
  RunningFront front(scripted_config(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint}, options_of("cell", 1));
  const TimePoint before = Clock::now();
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  const TimePoint after = Clock::now();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kDeadlineExceeded);
  EXPECT_EQ(answer.error().message, "after preprocess");
  const TimePoint deadline = told.get_future().get();
  EXPECT_GE(deadline, before + kBudget - std::chrono::milliseconds(1)) << "sent in milliseconds";
  EXPECT_LE(deadline, after + kBudget);
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
    const auto lost = client.plan(example_frame(16, 12 + i), example_request({"crash"}), kBudget);
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

TEST(Front, APlanThatNeedsTooMuchMemoryIsAnAnswer) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need all memory for themselves: workers have no limit there";
#endif
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(1), launcher);
  Client client({front.data_endpoint});
  const auto answer = client.plan(example_frame(), example_request({"hungry"}), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kInternal);
  EXPECT_THAT(answer.error().message, HasSubstr("worker_memory_limit_mib"));
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

  const auto bytes = client.plan(example_frame(), example_request({"throw_bytes"}), kBudget);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, Code::kInternal);
  EXPECT_THAT(bytes.error().message, HasSubstr("planning failed: \xef\xbf\xbd"));
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
