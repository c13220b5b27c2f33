#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "http_get.hpp"
#include "service_front_support.hpp"
#include "service_metrics_support.hpp"
#include "service_raw_client.hpp"

// What Prometheus reads of a real front.
namespace graspd::service {
namespace {

using client::Client;
using graspd::testing::http_get;
using graspd::testing::MetricsText;
using ::testing::HasSubstr;

void expect_counters_to_count_on(const MetricsText& before, const MetricsText& after) {
  for (const auto& [name, value] : before.series) {
    if (name.find("_total") != std::string::npos) {
      EXPECT_GE(after.at(name), value) << name;
    }
  }
}

TEST(Metrics, AreThereBeforeTheFirstRequestWithATypeEach) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(2), launcher);
  front.wait_ready();
  const MetricsText metrics = read(front);
  EXPECT_EQ(metrics.type.at("graspd_answers_total"), "counter");
  EXPECT_EQ(metrics.type.at("graspd_answer_seconds"), "histogram");
  EXPECT_EQ(metrics.type.at("graspd_queued_requests"), "gauge");
  for (const auto& [code, name] : EnumNames<Code>::values) {
    if (code == Code::kUnavailable) continue;
    EXPECT_EQ(metrics.at(answers("other", std::string(name))), 0);
  }
  EXPECT_EQ(metrics.at("graspd_planned_parts_total{part=\"echo\"}"), 0);
  EXPECT_EQ(metrics.at("graspd_workers_lost_total"), 0);
  EXPECT_EQ(metrics.at("graspd_build_info{build=\"scripted\",catalogue_hash=\"catalogue\","
                       "config_hash=\"config\"}"),
            1);
}

TEST(Metrics, CountEachKindOfAnswerOnce) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint}, options_of("cell", 1));
  const MetricsText before = read(front);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(client.plan(example_frame(), example_request({"echo", "other"}), kBudget));
  }
  EXPECT_FALSE(client.plan(example_frame(), example_request({"throw"}), kBudget));
  EXPECT_FALSE(client.plan(example_frame(), example_request({"gizmo"}), kBudget));
  RawClient raw(front.data_endpoint);
  raw.send({"no envelope", "no image"});
  EXPECT_EQ(raw.receive().code, Code::kInvalidArgument);

  wait_until_told(front);
  const MetricsText after = read(front);
  expect_counters_to_count_on(before, after);
  EXPECT_EQ(after.at(answers("other", "OK")), 3);
  EXPECT_EQ(after.at(answers("other", "INTERNAL")), 1);
  EXPECT_EQ(after.at(answers("other", "UNKNOWN_PART")), 1);
  EXPECT_EQ(after.at(answers("other", "INVALID_ARGUMENT")), 1);
  EXPECT_EQ(after.at("graspd_broken_total{code=\"INTERNAL\"}"), 1);
  EXPECT_EQ(after.at("graspd_shed_total{code=\"BUSY\"}"), 0);
  EXPECT_EQ(after.at("graspd_outcomes_total{outcome=\"PLANNED\"}"), 3);
  EXPECT_EQ(after.at("graspd_planned_parts_total{part=\"echo\"}"), 3);
  EXPECT_EQ(after.at("graspd_planned_parts_total{part=\"other\"}"), 3);
  EXPECT_EQ(after.at("graspd_answer_seconds_count"), 6);
  for (const std::string stage : {"queue", "decode", "script"}) {
    EXPECT_EQ(after.at("graspd_stage_seconds_count{stage=\"" + stage + "\"}"), 3);
  }
}

TEST(Metrics, WhatIsShedIsNotBroken) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(with_http(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint}, options_of("cell", 1));
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  // Two find a place in the cell's queue, the third takes that of the first.
  auto superseded = client.submit(example_frame(), example_request(), kBudget);
  auto second = client.submit(example_frame(), example_request(), kBudget);
  auto third = client.submit(example_frame(), example_request(), kBudget);
  EXPECT_EQ(superseded.get().error().code, Code::kSuperseded);
  wait_for_health(client, [](const HealthAnswer& health) { return health.queued_n == 2; });
  // The gauges follow at the end of the turn in which the front has answered.
  MetricsText metrics = read(front);
  while (metrics.at("graspd_queued_requests") != 2) metrics = read(front);
  EXPECT_EQ(metrics.at("graspd_workers{state=\"busy\"}"), 1);
  EXPECT_EQ(metrics.at("graspd_shed_total{code=\"SUPERSEDED\"}"), 1);
  EXPECT_EQ(metrics.at("graspd_broken_total{code=\"INTERNAL\"}"), 0);
  gate.open();
  EXPECT_TRUE(running.get());
  EXPECT_TRUE(second.get());
  EXPECT_TRUE(third.get());
}

TEST(Metrics, NothingThatClientsSendBecomesALabel) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(1), launcher);
  front.wait_ready();
  Client first({front.data_endpoint}, options_of("stranger 0"));
  ASSERT_TRUE(first.plan(example_frame(), example_request(), kBudget));
  wait_until_told(front);
  const MetricsText before = read(front);
  for (int i = 1; i < 20; ++i) {
    Client client({front.data_endpoint}, options_of("stranger " + std::to_string(i), 1));
    EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
    EXPECT_FALSE(
        client.plan(example_frame(), example_request({"gizmo" + std::to_string(i)}), kBudget));
  }
  wait_until_told(front);
  const MetricsText after = read(front);
  EXPECT_EQ(after.names(), before.names());
  EXPECT_EQ(after.at(answers("other", "OK")), 20);
  EXPECT_EQ(after.at(answers("other", "UNKNOWN_PART")), 19);
}

TEST(Metrics, CountLostWorkersAndSeeTheirMemory) {
  ProcessLauncher launcher = processes();
  RunningFront front(with_http(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint}, options_of("cell", 1));
  EXPECT_FALSE(client.plan(example_frame(), example_request({"crash"}), kBudget));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  MetricsText metrics = read(front);
  EXPECT_EQ(metrics.at("graspd_workers_lost_total"), 1);
  // Looked at once a second, at first perhaps while the worker's program was being loaded.
  while (metrics.at("graspd_memory_bytes{process=\"workers\"}") < 1e6) metrics = read(front);
  EXPECT_GT(metrics.at("graspd_memory_bytes{process=\"front\"}"), 1e6);
}

TEST(Metrics, HealthSaysTheSame) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(1), launcher);
  front.wait_ready();
  Client client({front.data_endpoint}, options_of("cell", 1));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  EXPECT_TRUE(client.plan(example_frame(), example_request(), kBudget));
  EXPECT_FALSE(client.plan(example_frame(), example_request({"throw"}), kBudget));
  const auto health = client.health(kBudget).at(0).health;
  ASSERT_TRUE(health) << health.error().message;
  ASSERT_EQ(health->answers_by_code.size(), 2u);
  EXPECT_EQ(health->answers_by_code[0].code, Code::kOk);
  EXPECT_EQ(health->answers_by_code[0].answers_n, 2u);
  EXPECT_EQ(health->answers_by_code[1].code, Code::kInternal);
  EXPECT_EQ(health->answers_by_code[1].answers_n, 1u);
  ASSERT_EQ(health->stages.size(), 3u);
  for (const StageTotal& stage : health->stages) {
    EXPECT_EQ(stage.runs_n, 2u) << stage.stage;
    EXPECT_GT(stage.total_ns, 0) << stage.stage;
  }
  EXPECT_GT(health->memory_bytes, 1'000'000u);
}

TEST(Http, IsOffUnlessTold) {
  ThreadLauncher launcher = threads();
  const RunningFront front(scripted_config(1), launcher);
  EXPECT_EQ(front.http_url, "");
}

TEST(Http, AnEndpointInUseIsNamed) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(1), launcher);
  ServerConfig config = with_http(1);
  config.http_endpoint = "tcp" + front.http_url.substr(4);
  try {
    const RunningFront second(config, launcher);
    FAIL() << "it listens where another server does";
  } catch (const CannotListen& error) {
    EXPECT_THAT(error.what(), HasSubstr("http: endpoint: " + config.http_endpoint));
  }
}

TEST(Http, OtherPagesAreNotThere) {
  ThreadLauncher launcher = threads();
  const RunningFront front(with_http(1), launcher);
  EXPECT_EQ(http_get(front.http_url, "/").status, 404);
  EXPECT_EQ(http_get(front.http_url, "/metrics/../../etc/passwd").status, 404);
}

}  // namespace
}  // namespace graspd::service
