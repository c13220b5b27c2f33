#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "graspd/trials/chaos_proxy.hpp"
#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kNetworkSeed = 7;

}  // namespace

Seen through_a_slow_network(std::size_t requests_n) {
  const auto server = start_server(2);
  ChaosProxy network(server->data_endpoint, kNetworkSeed);
  network.set({milliseconds(5), 1000});
  History history;
  ClosedLoop load(cells_of({network.endpoint()}, 4), history);
  history.wait_for(requests_n);
  load.stop();
  return seen_in(history);
}

Seen one_of_two_networks_stalls(std::size_t requests_n) {
  const auto first = start_server(2);
  const auto second = start_server(2);
  ChaosProxy network(first->data_endpoint, kNetworkSeed);
  History history;
  LoadOptions options = cells_of({network.endpoint(), second->data_endpoint}, 4);
  options.dispatch.attempt_timeout = milliseconds(500);
  ClosedLoop load(options, history);
  history.wait_for(requests_n);
  Chaos stalled;
  stalled.stalled = true;
  network.set(stalled);
  history.wait_for(requests_n);
  load.stop();
  return seen_in(history);
}

Seen connections_reset(std::size_t requests_n, int resets_n) {
  const auto first = start_server(2);
  const auto second = start_server(2);
  ChaosProxy network(first->data_endpoint, kNetworkSeed);
  History history;
  ClosedLoop load(cells_of({network.endpoint(), second->data_endpoint}, 4), history);
  for (int i = 0; i < resets_n; ++i) {
    history.wait_for(requests_n);
    network.reset_connections();
  }
  history.wait_for(requests_n);
  load.stop();
  return seen_in(history);
}

Seen faults_in_turn(std::size_t requests_n, int faults_n) {
  const auto first = start_server(2);
  const auto second = start_server(2);
  ChaosProxy networks[]{{first->data_endpoint, kNetworkSeed},
                        {second->data_endpoint, kNetworkSeed}};
  History history;
  LoadOptions options = cells_of({networks[0].endpoint(), networks[1].endpoint()}, 6);
  options.script = "echo";
  options.dispatch.attempt_timeout = milliseconds(300);
  ClosedLoop load(options, history);
  Chaos slow;
  slow.delay = milliseconds(3);
  Chaos chopped;
  chopped.chop_bytes = 5000;
  Chaos stalled;
  stalled.stalled = true;
  const Chaos faults[]{slow, stalled, chopped, {}};
  for (int i = 0; i < faults_n; ++i) {
    history.wait_for(requests_n);
    ChaosProxy& network = networks[i / 4 % 2];
    network.set(faults[i % 4]);
    if (i % 4 == 3) network.reset_connections();
  }
  load.stop();
  return seen_in(history);
}

OncePerId computations_per_id(int resets_n) {
  const testing::TemporaryFolder folder;
  const std::string log = folder.path() / "log";
  const auto server = start_server(2, {}, nullptr, log);
  ChaosProxy network(server->data_endpoint, kNetworkSeed);
  History history;
  LoadOptions options = cells_of({network.endpoint()}, 6);
  options.script = "sleep_100";  // longer than it takes to connect again
  ClosedLoop load(options, history);
  for (int i = 0; i < resets_n; ++i) {
    history.wait_for(20);
    network.reset_connections();
  }
  load.stop();
  server->kill(SIGTERM);
  server->wait();

  OncePerId seen;
  static_cast<Seen&>(seen) = seen_in(history);
  std::map<std::string, double> answered_ms;
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line);
    if (json.value("code", "") != "OK") continue;
    const double at_ms = json.at("at_ms");
    const double started_ms = at_ms - json.at("total_ms").get<double>();
    const auto [last, is_first] = answered_ms.try_emplace(json.at("request_id"), at_ms);
    ++seen.computed_n;
    if (is_first) continue;
    ++(started_ms < last->second ? seen.at_once_n : seen.again_n);
    last->second = at_ms;
  }
  return seen;
}

CorruptedNeighbour beside_a_corrupt_network(std::size_t requests_n) {
  const auto server = start_server(2);
  ChaosProxy network(server->data_endpoint, kNetworkSeed);
  Chaos corrupt;
  corrupt.corrupt_share = 0.1;
  network.set(corrupt);
  History corrupted_history;
  LoadOptions corrupted = cells_of({network.endpoint()}, 1);
  corrupted.name = "corrupted";
  corrupted.budget = milliseconds(300);
  corrupted.dispatch.max_attempts_n = 1;
  ClosedLoop beside(corrupted, corrupted_history);
  History history;
  ClosedLoop load(cells_of({server->data_endpoint}, 2), history);
  history.wait_for(requests_n);
  corrupted_history.wait_for(requests_n / 10);
  load.stop();
  beside.stop();
  CorruptedNeighbour seen;
  static_cast<Seen&>(seen) = seen_in(history);
  seen.corrupted = seen_in(corrupted_history);
  seen.workers_lost_n = static_cast<int>(health_of(server->data_endpoint).workers_lost_n);
  return seen;
}

}  // namespace graspd::trials
