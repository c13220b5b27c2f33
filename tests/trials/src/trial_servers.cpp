#include "trial_servers.hpp"

#include <fmt/format.h>

namespace graspd::trials {

std::unique_ptr<testing::ServeProcess> start_server(int workers_n, const std::string& endpoint) {
  std::vector<std::string> words{"--workers", std::to_string(workers_n)};
  if (!endpoint.empty()) words.insert(words.end(), {"--endpoint", endpoint});
  auto server = std::make_unique<testing::ServeProcess>(words);
  if (!server->wait_ready()) throw std::runtime_error("the scripted server did not start");
  return server;
}

LoadOptions cells_of(const std::vector<std::string>& endpoints, int cells_n) {
  LoadOptions options;
  options.endpoints = endpoints;
  options.cells_n = cells_n;
  return options;
}

HealthAnswer health_of(const std::string& endpoint) {
  client::Client client({endpoint});
  const auto health = client.health(std::chrono::seconds(5)).at(0).health;
  if (!health) throw std::runtime_error(health.error().message);
  return *health;
}

Seen seen_in(const History& history) {
  const Tally tally = history.tally();
  Seen seen;
  seen.asked_n = tally.asked_n;
  seen.failed_n = tally.asked_n - tally.ok_n();
  for (const auto& [code, count] : tally.ended_n) {
    seen.ended += fmt::format("{}{} {}", seen.ended.empty() ? "" : ", ", name_of(code), count);
  }
  seen.p50_ms = tally.quantile_ms(0.5);
  seen.worst_ms = tally.quantile_ms(1);
  seen.violations = history.violations();
  return seen;
}

}  // namespace graspd::trials
