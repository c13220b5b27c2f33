#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "service_authentication_support.hpp"
#include "service_raw_client.hpp"

// A front with keys: who comes in, and what of those who don't.
namespace graspd::service {
namespace {

using client::Client;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(AuthenticationTest, AnAllowedKeyIsServedOnBothSockets) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  Client client({front.data_endpoint, front.control_endpoint}, options_with(tees_));
  for (const client::ServerHealth& server : client.health(kBudget)) {
    ASSERT_TRUE(server.health) << server.health.error().message;
    EXPECT_EQ(server.health->state, ServerState::kReady);
  }
  Client planner({front.data_endpoint}, options_with(tees_));
  const auto answer = plan(planner);
  EXPECT_TRUE(answer) << answer.error().message;
}

TEST_F(AuthenticationTest, AnUnknownKeyIsRefusedWithASentenceToBothSides) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  const keys::KeyPair unknown = keys::make_key_pair("tees");
  for (const std::string& endpoint : {front.data_endpoint, front.control_endpoint}) {
    Client client({endpoint}, options_with(unknown));
    const auto health = client.health(kBudget).at(0).health;
    ASSERT_FALSE(health);
    EXPECT_EQ(health.error().code, Code::kUnauthenticated);
    EXPECT_THAT(health.error().message, AllOf(HasSubstr(endpoint), HasSubstr("grasp keys allow")));
  }
  front.wait_for_log("a client at 127.0.0.1 was refused: its key is not allowed");
  for (const std::string& line : front.log()) {
    for (const keys::KeyPair& pair : {unknown, tees_, server_}) {
      EXPECT_THAT(line, AllOf(Not(HasSubstr(pair.public_key)), Not(HasSubstr(pair.secret_key))));
    }
  }
}

TEST_F(AuthenticationTest, APlainClientIsRefusedAndNothingItSendsIsRead) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  RawClient raw(front.data_endpoint);
  raw.send(good_frames());
  Client plain({front.data_endpoint}, options_of("tees"));
  const auto refused = plan(plain);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kUnauthenticated);
  EXPECT_THAT(refused.error().message, HasSubstr("server_key"));
  Client good({front.data_endpoint}, options_with(tees_));
  EXPECT_TRUE(plan(good));
  EXPECT_FALSE(raw.answered_within(std::chrono::milliseconds(0)));
  EXPECT_EQ(good.health(kBudget).at(0).health->answered_n, 1u) << "the plan, and nothing else";
}

TEST_F(AuthenticationTest, AClientWithKeysDoesNotTalkToAServerWithout) {
  RunningFront front(scripted_config(1), launcher_);
  front.wait_ready();
  Client client({front.data_endpoint}, options_with(tees_));
  const auto refused = plan(client);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kUnauthenticated);
  EXPECT_THAT(refused.error().message, HasSubstr("does not use keys"));
}

TEST_F(AuthenticationTest, AClientDoesNotTalkToAServerWithAnotherKey) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  client::ClientOptions options = options_with(tees_);
  options.keys->server_key = keys::make_key_pair("server").public_key;
  options.dispatch.connect_timeout = std::chrono::milliseconds(300);
  Client client({front.data_endpoint}, options);
  const auto refused = plan(client);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kUnavailable);
  EXPECT_THAT(refused.error().message, HasSubstr("server_key"));
}

TEST_F(AuthenticationTest, AKeyAnswersForItsOwnCellAlone) {
  const keys::KeyPair elbows = keys::make_key_pair("elbows");
  allow(elbows);
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  client::ClientOptions options = options_with(elbows);
  options.cell = "tees";
  Client impostor({front.data_endpoint}, options);
  for (const auto& error : {plan(impostor).error(), impostor.health(kBudget)[0].health.error()}) {
    EXPECT_EQ(error.code, Code::kUnauthenticated);
    EXPECT_THAT(error.message, AllOf(HasSubstr("'tees'"), HasSubstr("the key of 'elbows'")));
  }
  Client honest({front.data_endpoint}, options_with(elbows));
  EXPECT_TRUE(plan(honest));
}

TEST_F(AuthenticationTest, AClientThatWasRefusedComesInOnceItsKeyIsAllowed) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  const keys::KeyPair elbows = keys::make_key_pair("elbows");
  Client client({front.data_endpoint}, options_with(elbows));
  EXPECT_EQ(plan(client).error().code, Code::kUnauthenticated);
  allow(elbows);
  front.reload();
  wait_until(client, true);
}

TEST_F(AuthenticationTest, AKeyThatIsRevokedIsRefusedWhileItsClientIsConnected) {
  const keys::KeyPair other = keys::make_key_pair("other");
  allow(other);
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  Client client({front.data_endpoint}, options_with(tees_));
  Client bystander({front.data_endpoint}, options_with(other));
  ASSERT_TRUE(plan(client));
  ASSERT_TRUE(plan(bystander));
  disallow("tees");
  front.reload();
  front.wait_for_log("1 keys are allowed");
  const auto refused = plan(client);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::kUnauthenticated);
  EXPECT_THAT(refused.error().message, HasSubstr("not allowed any more"));
  EXPECT_EQ(plan(client).error().code, Code::kUnauthenticated);
  EXPECT_TRUE(plan(bystander));
  allow(tees_);
  front.reload();
  wait_until(client, true);
}

TEST_F(AuthenticationTest, ACellGetsANewKeyWithoutAPause) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  const keys::KeyPair successor = keys::make_key_pair("tees");
  keys::AllowList before = keys::AllowList::read(list()).value();
  Client old_client({front.data_endpoint}, options_with(tees_));
  ASSERT_TRUE(plan(old_client));
  allow(successor);
  front.reload();
  front.wait_for_log("2 keys are allowed");
  Client new_client({front.data_endpoint}, options_with(successor));
  EXPECT_TRUE(plan(new_client));
  EXPECT_TRUE(plan(old_client));
  disallow("tees");
  allow(successor);
  front.reload();
  front.wait_for_log("1 keys are allowed");
  EXPECT_EQ(plan(old_client).error().code, Code::kUnauthenticated);
  EXPECT_TRUE(plan(new_client));
}

TEST_F(AuthenticationTest, AListThatCanNotBeReadLeavesTheLastOneInForce) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  std::filesystem::permissions(list(), std::filesystem::perms::all);
  front.reload();
  front.wait_for_log("the cells allowed so far stay allowed");
  Client client({front.data_endpoint}, options_with(tees_));
  EXPECT_TRUE(plan(client));
}

TEST_F(AuthenticationTest, ABrokenLineOfTheListIsLoggedAndTheRestIsKept) {
  std::ofstream(list(), std::ios::app) << "elbows no-key\n";
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  EXPECT_THAT(front.log(), Contains(HasSubstr("allowed_cells:4: is no line")));
  Client client({front.data_endpoint}, options_with(tees_));
  EXPECT_TRUE(plan(client));
  std::ofstream(list(), std::ios::app) << "bolts no-key either\n";
  front.reload();
  front.wait_for_log("allowed_cells:5: is no line");
  EXPECT_TRUE(plan(client));
}

TEST_F(AuthenticationTest, WithoutTheThreadNobodyIsLetInAndTheServerIsNotReady) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "thread sanitizer does not take it that a thread vanishes";
#endif
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  Client inside({front.data_endpoint}, options_with(tees_));
  ASSERT_TRUE(plan(inside));
  kill_zap_thread();
  wait_for_health(inside, [](const HealthAnswer& h) { return h.state != ServerState::kReady; });
  front.wait_for_log("authentication does not answer");
  for (const keys::KeyPair& pair : {tees_, keys::make_key_pair("tees")}) {
    client::ClientOptions options = options_with(pair);
    options.dispatch.connect_timeout = std::chrono::milliseconds(300);
    Client outside({front.data_endpoint}, options);
    EXPECT_FALSE(plan(outside));
  }
}

TEST_F(AuthenticationTest, AServerWhoseAuthenticationFailsItsTestDoesNotStart) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "thread sanitizer does not take it that a thread vanishes";
#endif
  PrivateDirectory directory;
  FrontOptions options;
  options.config = config();
  options.worker_endpoint = "ipc://" + (directory.path() / "workers").string();
  options.on_ready = [] { FAIL() << "it says that it is ready"; };
  with_keys()(options);
  Front front(options, launcher_);
  kill_zap_thread();
  try {
    front.run();
    FAIL() << "it runs";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("authentication does not work, so that this server does "
                                        "not start: "));
  }
}

}  // namespace
}  // namespace graspd::service
