#include "graspd/client/client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <thread>
#include <zmq.hpp>

#include "client_fake_server.hpp"
#include "client_support.hpp"
#include "graspd/codec/codec.hpp"

// The client library against servers that do what the test says.
namespace graspd::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr seconds kBudget{20};

TEST(Client, SaysWhereNoServerIsAndWhatToCheck) {
  // Bound and closed again, so that nobody listens there.
  std::string endpoint;
  {
    FakeServer gone(says(""));
    endpoint = gone.endpoint;
  }
  Client client({endpoint});
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kUnavailable);
  EXPECT_THAT(answer.error().message, HasSubstr(endpoint));
  EXPECT_THAT(answer.error().message, HasSubstr("check that grasp_server runs there"));
}

TEST(Client, SomethingThatListensButIsNoServerIsNone) {
  zmq::context_t context;
  zmq::socket_t stream(context, zmq::socket_type::stream);
  stream.bind("tcp://127.0.0.1:*");
  Client client({stream.get(zmq::sockopt::last_endpoint)});
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kUnavailable);
}

/// Hangs up before its greeting is out, as a server may that has read in the other's that they have
/// no mechanism in common; greets who does not say what it speaks (11 bytes).
void hang_up_or_greet(zmq::socket_t stream, const std::string& mechanism) {
  std::string greeting = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0", 12) + mechanism;
  greeting.resize(64, '\0');
  try {
    while (true) {
      zmq::message_t peer;
      zmq::message_t bytes;
      (void)stream.recv(peer);
      (void)stream.recv(bytes);
      if (bytes.empty()) continue;  // came or went
      stream.send(peer, zmq::send_flags::sndmore);
      stream.send(zmq::buffer(bytes.size() == 11 ? greeting : ""), zmq::send_flags::none);
    }
  } catch (const zmq::error_t& error) {
    ASSERT_EQ(error.num(), ETERM);
  }
}

TEST(Client, FindsOutWhyAServerOfAnotherMechanismHungUp) {
  for (const std::string mechanism : {"CURVE", "NULL"}) {
    zmq::context_t context;
    zmq::socket_t stream(context, zmq::socket_type::stream);
    stream.set(zmq::sockopt::linger, 0);
    stream.bind("tcp://127.0.0.1:*");
    const std::string endpoint = stream.get(zmq::sockopt::last_endpoint);
    std::thread server([&] { hang_up_or_greet(std::move(stream), mechanism); });
    Client plain({endpoint});
    const auto answer = plain.plan(example_frame(), example_request(), kBudget);
    ASSERT_FALSE(answer);
    const bool same = mechanism == "NULL";
    EXPECT_EQ(answer.error().code, same ? Code::kUnavailable : Code::kUnauthenticated);
    context.shutdown();
    server.join();
  }
}

TEST(Client, RefusesWhatIsNoEndpoint) {
  EXPECT_THROW(Client({"localhost"}), std::invalid_argument);
  EXPECT_THROW(Client({"tcp://127.0.0.1:port"}), std::invalid_argument);
  EXPECT_THROW(Client(std::vector<std::string>{}), std::invalid_argument);
}

TEST(Client, RefusesABadFrameWithoutSendingIt) {
  FakeServer server(says("sent"));
  Client client({server.endpoint});
  DepthFrame frame = example_frame();
  frame.depth.assign(frame.depth.size(), 0);
  EXPECT_EQ(client.plan(frame, example_request(), kBudget).error().code, Code::kInvalidArgument);
  PlanRequest request = example_request();
  request.parts.clear();
  EXPECT_EQ(client.plan(example_frame(), request, kBudget).error().code, Code::kInvalidArgument);
  EXPECT_TRUE(server.stop().empty());
}

TEST(Client, SendsTheWholeRequest) {
  FakeServer server(says(""));
  ClientOptions options;
  options.cell = "cell_3";
  Client client({server.endpoint}, options);
  ASSERT_TRUE(client.plan(example_frame(), example_request({"tee", "elbow"}), kBudget));
  const std::vector<Request> all = server.stop();
  ASSERT_EQ(all.size(), 1u);
  const Request& seen = all[0];
  EXPECT_EQ(seen.cell, "cell_3");
  EXPECT_EQ(seen.attempt, 1u);
  EXPECT_GT(seen.budget_ms, 15'000u);
  EXPECT_LE(seen.budget_ms, 20'000u);
  const auto& call = std::get<PlanCall>(seen.call);
  EXPECT_EQ(call.frame.camera.width_px, 16);
  EXPECT_EQ(call.plan.parts.at(1).id, "elbow");
}

TEST(Client, AsksAnotherServerWhereOneIsSilent) {
  FakeServer silent([](const Request&) { return std::vector<Answer>{}; });
  FakeServer good(says("good"));
  ClientOptions options;
  options.dispatch.attempt_timeout = milliseconds(100);
  Client client({silent.endpoint, good.endpoint}, options);
  for (int i = 0; i < 5; ++i) {
    const auto answer = client.plan(example_frame(), example_request(), kBudget);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->reason, "good");
  }
}

TEST(Client, AServerThatDiesWithARequestIsReplacedAtOnce) {
  std::promise<void> arrived;
  auto dying = std::make_unique<FakeServer>([&arrived](const Request&) {
    arrived.set_value();
    return std::vector<Answer>{};
  });
  FakeServer good(says("good"));
  ClientOptions options;
  options.dispatch.attempt_timeout = kBudget;  // only the lost connection can tell
  Client client({dying->endpoint, good.endpoint}, options);
  // Both are connected then, so that each is asked one of two calls.
  for (const ServerHealth& server : client.health(kBudget)) ASSERT_TRUE(server.health);
  std::vector<std::future<Result<PlanAnswer>>> answers;
  for (int i = 0; i < 2; ++i) {
    answers.push_back(client.submit(example_frame(), example_request(), kBudget));
  }
  arrived.get_future().wait();
  dying.reset();
  for (auto& answer : answers) {
    const auto result = answer.get();
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->reason, "good");
  }
}

TEST(Client, ComesBackToABusyServerWhenItSaid) {
  FakeServer server([](const Request& request) {
    return std::vector{request.attempt < 3 ? refusal(request, Code::kBusy, 40)
                                           : ok(request, "third time")};
  });
  Client client({server.endpoint});
  const auto start = Clock::now();
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_GE(Clock::now() - start, milliseconds(80));
  EXPECT_EQ(answer->reason, "third time");
}

TEST(Client, GivesUpAfterThreeAttemptsWithTheServersWords) {
  FakeServer server(
      [](const Request& request) { return std::vector{refusal(request, Code::kBusy, 1)}; });
  Client client({server.endpoint});
  const auto answer = client.plan(example_frame(), example_request(), kBudget);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Code::kBusy);
  EXPECT_EQ(answer.error().message, "because (3 attempts)");
  EXPECT_EQ(server.stop().size(), 3u);
}

TEST(Client, DropsAnswersOfOtherRequests) {
  FakeServer server([](const Request& request) {
    Request other = request;
    other.id[0] = static_cast<std::uint8_t>(~other.id[0]);
    // A stranger's, ours, and ours again.
    return std::vector{ok(other, "wrong"), ok(request, "right"), ok(request, "late")};
  });
  Client client({server.endpoint});
  for (int i = 0; i < 20; ++i) {
    const auto answer = client.plan(example_frame(), example_request(), kBudget);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->reason, "right");
  }
}

TEST(Client, AnswersManyThreadsAtOnce) {
  FakeServer first(says("answer"));
  FakeServer second(says("answer"));
  Client client({first.endpoint, second.endpoint});
  std::vector<std::future<Result<PlanAnswer>>> answers;
  for (int i = 0; i < 200; ++i) {
    answers.push_back(client.submit(example_frame(), example_request(), kBudget));
  }
  for (auto& answer : answers) EXPECT_TRUE(answer.get());
  EXPECT_EQ(first.stop().size() + second.stop().size(), 200u);
}

TEST(Client, ClosingItEndsWhatIsInFlight) {
  FakeServer silent([](const Request&) { return std::vector<Answer>{}; });
  std::future<Result<PlanAnswer>> answer;
  {
    Client client({silent.endpoint});
    answer = client.submit(example_frame(), example_request(), kBudget);
  }
  EXPECT_EQ(answer.get().error().code, Code::kUnavailable);
}

TEST(Client, HealthNamesTheServerThatIsNotThere) {
  FakeServer there(says(""));
  Client client({there.endpoint, "tcp://127.0.0.1:1"});
  const auto health = client.health(kBudget);
  ASSERT_EQ(health.size(), 2u);
  ASSERT_TRUE(health[0].health);
  EXPECT_EQ(health[0].health->part_ids, std::vector<std::string>{"tee"});
  ASSERT_FALSE(health[1].health);
  EXPECT_EQ(health[1].health.error().code, Code::kUnavailable);
  EXPECT_THAT(health[1].health.error().message, HasSubstr("tcp://127.0.0.1:1"));
}

}  // namespace
}  // namespace graspd::client
