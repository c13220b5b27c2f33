#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "daemon.hpp"
#include "graspd/trials/fleet.hpp"
#include "namespaces.hpp"
#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::milliseconds;

// As deploy/haproxy/haproxy.cfg has them.
const std::string kBalancer = "10.0.0.10";
const std::array<std::string, 2> kServers{"10.0.0.11", "10.0.0.12"};

std::string endpoint(const std::string& address) { return "tcp://" + address + ":5555"; }

}  // namespace

BehindHaproxy kill_one_server_behind_haproxy(std::size_t requests_n) {
  const NetworkNamespace network;
  network.run(fmt::format("ip addr add {} dev lo", kBalancer));
  for (const std::string& server : kServers)
    network.run(fmt::format("ip addr add {} dev lo", server));
  const testing::TemporaryFolder folder;
  const Keyring keys(
      {"cell_0", "cell_1", "cell_2", "cell_3", "cell_4", "cell_5", "cell_6", "cell_7"});
  std::array<std::unique_ptr<testing::ServeProcess>, 2> servers;
  const auto start = [&](std::size_t i) {
    network.in([&] { servers.at(i) = start_server(2, endpoint(kServers.at(i)), &keys); });
  };
  start(0);
  start(1);
  const Daemon haproxy(
      fmt::format("exec nsenter --net={} haproxy -db -f {}/deploy/haproxy/haproxy.cfg",
                  network.path(), GRASPD_SOURCE_DIR),
      folder.path() / "haproxy.log");

  BehindHaproxy seen;
  History history;
  network.in([&] {
    LoadOptions options = cells_of({endpoint(kBalancer)}, 8);
    options.keys = keys.of_cells();
    options.dispatch.attempt_timeout = milliseconds(500);
    client::ClientOptions probe;
    probe.cell = "cell_0";
    probe.keys = keys.of_cells().at("cell_0");
    const auto answers_of = [&](const std::string& address) {
      client::Client client({endpoint(address)}, probe);
      const auto health = client.health(std::chrono::seconds(1)).at(0).health;
      return health ? static_cast<int>(health->answered_n) : -1;
    };
    const TimePoint until = Clock::now() + std::chrono::seconds(20);
    while (answers_of(kBalancer) < 0) {
      if (Clock::now() > until) throw std::runtime_error("no answer through haproxy in 20 s");
    }
    ClosedLoop load(options, history);
    history.wait_for(requests_n);
    for (const std::string& server : kServers) seen.answers_n.push_back(answers_of(server));
    servers[0]->kill(SIGKILL);
    history.wait_for(requests_n);
    start(0);
    history.wait_for(requests_n);
    load.stop();
  });
  static_cast<Seen&>(seen) = seen_in(history);
  return seen;
}

std::string why_no_haproxy() {
  if (testing::run("command -v haproxy").exit_code != 0) {
    return "haproxy is not installed: deploy/install-deps --deploy";
  }
  return why_no_namespaces();
}

}  // namespace graspd::trials
