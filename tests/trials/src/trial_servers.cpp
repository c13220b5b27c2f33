#include "trial_servers.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <type_traits>

#include "graspd/keys/allow_list.hpp"

namespace graspd::trials {

namespace {

template <class T>
T or_throw(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace

Keyring::Keyring(const std::vector<std::string>& cells)
    : Keyring([&] {
        std::map<std::string, keys::ClientKeys> made;
        for (const std::string& cell : cells) made[cell].own = keys::make_key_pair(cell);
        return made;
      }()) {}

Keyring::Keyring(const std::map<std::string, keys::ClientKeys>& cells) : of_cells_(cells) {
  const keys::KeyPair server = keys::make_key_pair("server");
  or_throw(keys::write_key_pair(server, folder_.path()));
  for (auto& [cell, keys] : of_cells_) {
    or_throw(keys::allow(folder_.path() / "allowed_cells", {cell, keys.own.public_key}));
    keys.server_key = server.public_key;
  }
}

std::vector<std::string> Keyring::server_words() const {
  return {"--key", folder_.path() / "server.key", "--allowed-cells",
          folder_.path() / "allowed_cells"};
}

void Keyring::revoke(const std::string& cell) const {
  or_throw(keys::revoke(folder_.path() / "allowed_cells", cell));
}

std::unique_ptr<testing::ServeProcess> start_server(int workers_n, const std::string& endpoint,
                                                    const Keyring* keys, const std::string& log) {
  std::vector<std::string> words{"--workers", std::to_string(workers_n)};
  if (!endpoint.empty()) words.insert(words.end(), {"--endpoint", endpoint});
  if (keys != nullptr) {
    const std::vector<std::string> more = keys->server_words();
    words.insert(words.end(), more.begin(), more.end());
  }
  auto server = std::make_unique<testing::ServeProcess>(words, log);
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

std::size_t descriptors_n(pid_t pid) {
  const auto folder = std::filesystem::path("/proc") / std::to_string(pid) / "fd";
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder),
                                                std::filesystem::directory_iterator()));
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
  seen.p99_ms = tally.quantile_ms(0.99);
  seen.worst_ms = tally.quantile_ms(1);
  seen.violations = history.violations();
  return seen;
}

}  // namespace graspd::trials
