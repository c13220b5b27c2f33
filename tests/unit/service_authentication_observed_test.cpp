#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "http_get.hpp"
#include "service_authentication_support.hpp"
#include "service_metrics_support.hpp"

// What metrics and /readyz say of a front with keys.
namespace graspd::service {
namespace {

using client::Client;
using graspd::testing::http_get;
using graspd::testing::MetricsText;
using ::testing::HasSubstr;

std::string failures(const std::string& reason) {
  return "graspd_auth_failures_total{reason=\"" + reason + "\"}";
}

TEST_F(AuthenticationTest, ACellIsCountedByItsNameFromTheStartAndAfterAReload) {
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  EXPECT_EQ(read(front).at(answers("tees", "OK")), 0);
  Client tees({front.data_endpoint}, options_with(tees_));
  ASSERT_TRUE(plan(tees));

  const keys::KeyPair elbows = keys::make_key_pair("elbows");
  allow(elbows);
  disallow("tees");
  front.reload();
  front.wait_for_log("1 keys are allowed");
  EXPECT_EQ(read(front).at(answers("elbows", "OK")), 0);
  Client client({front.data_endpoint}, options_with(elbows));
  ASSERT_TRUE(plan(client));
  const MetricsText after = read(front);
  EXPECT_EQ(after.at(answers("elbows", "OK")), 1);
  EXPECT_EQ(after.at(answers("tees", "OK")), 1) << "what was counted stays";
  EXPECT_EQ(after.at(answers("other", "OK")), 0);
}

TEST_F(AuthenticationTest, WhoIsNotLetInIsCountedByTheReason) {
  const keys::KeyPair elbows = keys::make_key_pair("elbows");
  allow(elbows);
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  Client tees({front.data_endpoint}, options_with(tees_));
  ASSERT_TRUE(plan(tees));
  const MetricsText before = read(front);
  for (const char* reason : {"unknown_key", "wrong_cell", "revoked_key"}) {
    EXPECT_EQ(before.at(failures(reason)), 0);
  }

  client::ClientOptions as_tees = options_with(elbows);
  as_tees.cell = "tees";
  Client impostor({front.data_endpoint}, as_tees);
  EXPECT_FALSE(plan(impostor));
  MetricsText metrics = read(front);
  EXPECT_EQ(metrics.at(failures("wrong_cell")), 1);
  EXPECT_EQ(metrics.at(answers("elbows", "UNAUTHENTICATED")), 1) << "by the key, not by the claim";
  EXPECT_EQ(metrics.at(answers("tees", "UNAUTHENTICATED")), 0);

  disallow("tees");
  front.reload();
  front.wait_for_log("1 keys are allowed");
  EXPECT_FALSE(plan(tees));
  metrics = read(front);
  EXPECT_EQ(metrics.at(failures("revoked_key")), 1);
  EXPECT_EQ(metrics.at(answers("other", "UNAUTHENTICATED")), 1);

  // Its new connection is refused by the thread that answers libzmq, of which the front hears
  // later.
  Client stranger({front.data_endpoint}, options_with(keys::make_key_pair("stranger")));
  EXPECT_FALSE(plan(stranger));
  while (read(front).at(failures("unknown_key")) == 0) {
  }
  EXPECT_EQ(read(front).names(), before.names()) << "no label is a client's";
}

TEST_F(AuthenticationTest, ReadyMeansThatAuthenticationAnswers) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "thread sanitizer does not take it that a thread vanishes";
#endif
  RunningFront front(config(), launcher_, with_keys());
  front.wait_ready();
  while (http_get(front.http_url, "/readyz").status != 200) {
  }
  kill_zap_thread();
  testing::HttpAnswer page;
  while (page.status != 503) page = http_get(front.http_url, "/readyz");
  EXPECT_THAT(page.body, HasSubstr("authentication does not answer"));
  EXPECT_EQ(read(front).at("graspd_ready"), 0);
  EXPECT_EQ(http_get(front.http_url, "/livez").status, 200);
}

}  // namespace
}  // namespace graspd::service
