#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "http_get.hpp"
#include "metrics_text.hpp"
#include "service_front_support.hpp"
#include "temporary_folder.hpp"

// New parts while the server serves, and a second server where one runs.
namespace graspd::service {
namespace {

using client::Client;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

const ServerInfo kNewServer{"scripted", "catalogue-2", "config"};
const std::string kNewPartsInForce = fmt::format("{} parts in force", kScriptedParts.size() + 1);

/// Facts and workers of a catalogue that has one part more.
NewParts new_parts(PlanHandler handler = scripted_plan, ServerInfo server = kNewServer) {
  NewParts parts;
  parts.facts = {kScriptedParts, server};
  parts.facts.part_ids.push_back("novelty");
  parts.launcher = std::make_unique<ThreadLauncher>(std::move(handler), std::move(server));
  return parts;
}

auto loading(std::function<Result<NewParts>()> load) {
  return [load = std::move(load)](FrontOptions& options) { options.load_parts = load; };
}

Result<PlanAnswer> plan(Client& client, const std::string& part = "echo") {
  return client.plan(example_frame(), example_request({part}), kBudget);
}

TEST(Reload, NewPartsComeIntoForce) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(2), launcher, loading([] { return new_parts(); }));
  front.wait_ready();
  Client client({front.data_endpoint});
  EXPECT_EQ(plan(client, "novelty").error().code, Code::kUnknownPart);
  front.reload();
  front.wait_for_log(kNewPartsInForce);
  const auto answer = plan(client, "novelty");
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->server.catalogue_hash, "catalogue-2");
  const auto health = client.health(kBudget).at(0).health;
  EXPECT_EQ(health->server.catalogue_hash, "catalogue-2");
  EXPECT_THAT(health->part_ids, Contains("novelty"));
  EXPECT_EQ(health->workers_n, 2u);
}

TEST(Reload, PartsThatChangeWhileTheServerStartsAreTakenUp) {
  // The front has read the old ones, its workers the new ones: all are unfit, again and again.
  ThreadLauncher launcher(scripted_plan, kNewServer);
  RunningFront front(scripted_config(6), launcher, loading([] {
                       std::this_thread::sleep_for(std::chrono::milliseconds(500));
                       return new_parts();
                     }));
  front.reload();
  front.wait_ready();
  Client client({front.data_endpoint});
  const auto answer = plan(client, "novelty");
  ASSERT_TRUE(answer) << answer.error().message;
  // The crew that never worked is gone: the next reload does not wait for it.
  front.reload();
  front.wait_for_log("the parts have not changed");
}

TEST(Reload, MetricsTellOfTheNewParts) {
  ThreadLauncher launcher = threads();
  RunningFront front(with_http(1), launcher, loading([] { return new_parts(); }));
  front.wait_ready();
  front.reload();
  front.wait_for_log(kNewPartsInForce);
  Client client({front.data_endpoint});
  ASSERT_TRUE(plan(client, "novelty"));
  wait_until_told(front);
  const auto metrics = testing::parse_metrics(testing::http_get(front.http_url, "/metrics").body);
  EXPECT_EQ(metrics.at("graspd_planned_parts_total{part=\"novelty\"}"), 1);
  EXPECT_EQ(metrics.at("graspd_planned_parts_total{part=\"echo\"}"), 0);
  const auto builds = [&](const std::string& catalogue) {
    return metrics.series.count("graspd_build_info{build=\"scripted\",catalogue_hash=\"" +
                                catalogue + "\",config_hash=\"config\"}");
  };
  EXPECT_EQ(builds("catalogue-2"), 1u);
  EXPECT_EQ(builds("catalogue"), 0u) << "a server has one build";
}

TEST(Reload, WhatWasAcceptedIsFinishedAndTheNewWorkersDoNotWaitForIt) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  RunningFront front(scripted_config(1), launcher, loading([] { return new_parts(); }));
  front.wait_ready();
  Client client({front.data_endpoint});
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  auto queued = client.submit(example_frame(), example_request(), kBudget);
  wait_for_health(client, [](const HealthAnswer& health) { return health.queued_n == 1; });
  front.reload();
  const auto second = queued.get();
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(second->server.catalogue_hash, "catalogue-2");
  gate.open();
  const auto first = running.get();
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->server.catalogue_hash, "catalogue");
  wait_until_told(front);
  EXPECT_THAT(front.log(), Contains(AllOf(HasSubstr("\"code\":\"OK\""),
                                          HasSubstr("\"catalogue_hash\":\"catalogue\""))))
      << "the log says what it was computed with, not what is in force";
}

TEST(Reload, HealthIsAnsweredWhileThePartsLoad) {
  std::promise<void> loaded;
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher, loading([&] {
                       loaded.get_future().wait();
                       return new_parts();
                     }));
  front.wait_ready();
  Client client({front.data_endpoint});
  front.reload();
  front.wait_for_log("loading the parts");
  EXPECT_EQ(client.health(kBudget).at(0).health->state, ServerState::kReady);
  EXPECT_TRUE(plan(client));
  loaded.set_value();
  front.wait_for_log(kNewPartsInForce);
}

TEST(Reload, ABadCatalogueKeepsTheOldOneAndSaysWhy) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher, loading([]() -> Result<NewParts> {
                       return invalid("tee/part.yaml:3: no such mesh");
                     }));
  front.wait_ready();
  front.reload();
  front.wait_for_log("the parts in force stay, since the new ones are wrong: tee/part.yaml:3: no");
  Client client({front.data_endpoint});
  EXPECT_EQ(plan(client)->server.catalogue_hash, "catalogue");
}

TEST(Reload, ALoaderThatThrowsKeepsTheOldOneAndSaysWhy) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher, loading([]() -> Result<NewParts> {
                       throw std::runtime_error("no memory left");
                     }));
  front.wait_ready();
  front.reload();
  front.wait_for_log("no memory left");
  Client client({front.data_endpoint});
  EXPECT_TRUE(plan(client));
}

TEST(Reload, WorkersThatDoNotStartKeepTheOldOnes) {
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher, loading([]() -> Result<NewParts> {
                       NewParts parts = new_parts();
                       parts.launcher = std::make_unique<ProcessLauncher>(
                           "/bin/false", std::vector<std::string>{"false"});
                       return parts;
                     }));
  front.wait_ready();
  front.reload();
  front.wait_for_log("reload: the parts in force stay: workers end before they are ready");
  Client client({front.data_endpoint});
  EXPECT_EQ(plan(client)->server.catalogue_hash, "catalogue");
}

TEST(Reload, PartsThatHaveNotChangedReplaceNobody) {
  std::atomic<int> loads = 0;
  ThreadLauncher launcher = threads();
  RunningFront front(scripted_config(1), launcher, loading([&] {
                       ++loads;
                       return new_parts(scripted_plan, kScriptedServer);
                     }));
  front.wait_ready();
  front.reload();
  front.wait_for_log("the parts have not changed");
  EXPECT_EQ(loads, 1);
}

TEST(Reload, UnderLoadNothingFails) {
  std::atomic<int> version = 0;
  ProcessLauncher launcher = processes();
  RunningFront front(scripted_config(2), launcher, loading([&] {
                       const std::string hash = "catalogue-" + std::to_string(++version);
                       return new_parts(scripted_plan, {"scripted", hash, "config"});
                     }));
  front.wait_ready();
  std::atomic<bool> enough = false;
  std::atomic<int> answered_n = 0;
  std::vector<std::thread> cells;
  for (int cell = 0; cell < 3; ++cell) {
    cells.emplace_back([&, cell] {
      Client client({front.data_endpoint}, options_of(std::to_string(cell), 1));
      while (!enough) {
        const auto answer = plan(client);
        EXPECT_TRUE(answer) << answer.error().message;
        ++answered_n;
      }
    });
  }
  for (int reload = 1; reload <= 5; ++reload) {
    const int before = answered_n;
    while (answered_n < before + 50) std::this_thread::yield();
    front.reload();
    front.wait_for_log("catalogue catalogue-" + std::to_string(reload));
  }
  enough = true;
  for (std::thread& cell : cells) cell.join();
  EXPECT_GE(answered_n, 250);
  for (const std::string& line : front.log())
    EXPECT_THAT(line, ::testing::Not(HasSubstr("is gone")));
}

TEST(Reload, IsNotBegunWhileDraining) {
  Gate gate;
  ThreadLauncher launcher = threads(gate.handler());
  std::atomic<int> loads = 0;
  RunningFront front(scripted_config(1), launcher, loading([&] {
                       ++loads;
                       return new_parts();
                     }));
  front.wait_ready();
  Client client({front.data_endpoint});
  auto running = client.submit(example_frame(), example_request(), kBudget);
  gate.wait_for_entered(1);
  front.stop();
  front.wait_for_log("draining");
  front.reload();
  gate.open();
  EXPECT_TRUE(running.get());
  EXPECT_EQ(front.wait_end(), "");
  EXPECT_EQ(loads, 0);
}

TEST(SecondServer, IsRefusedOnAnIpcEndpointAndTheFirstGoesOn) {
  const testing::TemporaryFolder folder;
  ServerConfig config = scripted_config(1);
  config.data_endpoint = "ipc://" + (folder.path() / "data").string();
  config.control_endpoint = "ipc://" + (folder.path() / "control").string();
  ThreadLauncher launcher = threads();
  {
    RunningFront front(config, launcher);
    front.wait_ready();
    Client client({config.data_endpoint});
    ASSERT_TRUE(plan(client));
    for (const bool same_data : {true, false}) {
      ServerConfig second = config;
      (same_data ? second.control_endpoint : second.data_endpoint) = "tcp://127.0.0.1:*";
      try {
        RunningFront intruder(second, launcher);
        FAIL() << "two servers on one endpoint";
      } catch (const CannotListen& error) {
        EXPECT_THAT(error.what(), HasSubstr("is in use: another server runs there"));
      }
    }
    Client late({config.data_endpoint});
    EXPECT_TRUE(plan(late));
    EXPECT_TRUE(plan(client));
  }
  // And it can be had again.
  RunningFront successor(config, launcher);
  Client client({config.data_endpoint});
  EXPECT_TRUE(plan(client));
}

}  // namespace
}  // namespace graspd::service
