#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "client_support.hpp"
#include "graspd/client/client.hpp"
#include "service_support.hpp"

/// What tests of the front have in common: launchers of scripted workers, and the real client.
namespace graspd::service {

inline constexpr std::chrono::seconds kBudget{20};

inline ProcessLauncher processes() { return {GRASPD_SCRIPTED_WORKER, {"scripted_worker"}}; }
inline ThreadLauncher threads(PlanHandler handler = scripted_plan) {
  return {std::move(handler), kScriptedServer};
}

inline ServerConfig with_http(std::uint32_t workers_n) {
  ServerConfig config = scripted_config(workers_n);
  config.http_endpoint = "tcp://127.0.0.1:0";
  return config;
}

inline client::ClientOptions options_of(const std::string& cell, std::uint32_t max_attempts_n = 3) {
  client::ClientOptions options;
  options.cell = cell;
  options.dispatch.max_attempts_n = max_attempts_n;
  return options;
}

/// Asks until the answer is as wanted. Health never waits for work, so this is quick.
inline void wait_for_health(client::Client& client,
                            const std::function<bool(const HealthAnswer&)>& wanted) {
  while (true) {
    const auto health = client.health(kBudget).at(0).health;
    ASSERT_TRUE(health) << health.error().message;
    if (wanted(*health)) return;
  }
}

/// An answer leaves before the log's line is written and metrics count it. The front does both
/// before it answers anything else.
inline void wait_until_told(const RunningFront& front) {
  client::Client client({front.control_endpoint});
  wait_for_health(client, [](const HealthAnswer&) { return true; });
}

}  // namespace graspd::service
