#include "graspd/trials/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::milliseconds;
using testing::ServeProcess;

// Seldom enough that a request never meets the one before, and no multiple of what a worker takes.
constexpr double kQuiet_hz = 7;

/// Plans and refusals, without health.
int answers_n(const HealthAnswer& health) {
  std::uint64_t sum = 0;
  for (const CodeCount& count : health.answers_by_code) sum += count.answers_n;
  return static_cast<int>(sum);
}

double seconds_since(TimePoint start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// User and system time of a process so far.
double cpu_ms(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string word;
  // The second field is a name in brackets without blanks; times are the fields 14 and 15.
  for (int field = 1; field < 14; ++field) stat >> word;
  double user = 0;
  double system = 0;
  stat >> user >> system;
  return (user + system) * 1000 / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

Seen kill_one_of_two_servers(std::size_t requests_n) {
  const auto first = start_server(2);
  const auto second = start_server(2);
  History history;
  ClosedLoop load(cells_of({first->data_endpoint, second->data_endpoint}, 4), history);
  history.wait_for(requests_n);
  first->kill(SIGKILL);
  history.wait_for(requests_n);
  load.stop();
  return seen_in(history);
}

Seen kill_workers(std::size_t requests_n, int workers_lost_n) {
  const auto server = start_server(2);
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 4);
  for (int i = 0; i < workers_lost_n; ++i) {
    // Other cells each time: no question of theirs is at two deaths, which would be poison.
    options.name = fmt::format("cell_{}", i);
    ClosedLoop load(options, history);
    history.wait_for(requests_n);
    const std::vector<pid_t> workers = server->workers();
    if (!workers.empty()) ::kill(workers.front(), SIGKILL);
    history.wait_for(requests_n);
  }
  return seen_in(history);
}

RollingRestart rolling_restart(std::size_t requests_n) {
  std::vector<std::unique_ptr<ServeProcess>> servers;
  for (int i = 0; i < 2; ++i) servers.push_back(start_server(2));
  std::vector<std::string> endpoints;
  for (const auto& server : servers) endpoints.push_back(server->data_endpoint);
  History history;
  ClosedLoop load(cells_of(endpoints, 4), history);
  RollingRestart restart;
  for (std::size_t i = 0; i < servers.size(); ++i) {
    history.wait_for(requests_n);
    const TimePoint told = Clock::now();
    servers[i]->kill(SIGTERM);
    restart.exit_codes.push_back(servers[i]->wait());
    restart.longest_stop_s = std::max(restart.longest_stop_s, seconds_since(told));
    servers[i] = start_server(2, endpoints[i]);
    // The next one may go when clients have found this one again.
    while (answers_n(health_of(endpoints[i])) < static_cast<int>(requests_n)) {
      history.wait_for(1);
    }
  }
  load.stop();
  static_cast<Seen&>(restart) = seen_in(history);
  return restart;
}

OpenLoop open_loop(double capacity_share, int requests_n) {
  const auto server = start_server(2);
  OpenLoop seen;
  {
    History history;
    const TimePoint start = Clock::now();
    ClosedLoop load(cells_of({server->data_endpoint}, 6), history);
    history.wait_for(static_cast<std::size_t>(requests_n) / 2);
    load.stop();
    seen.peak_hz = history.tally().ok_n() / seconds_since(start);
  }
  const int before_n = answers_n(health_of(server->data_endpoint));
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 6);
  options.budget = milliseconds(500);
  options.dispatch.max_attempts_n = 1;  // every refusal is seen
  const TimePoint start = Clock::now();
  run_open_loop(options, capacity_share * seen.peak_hz, requests_n, history);
  const double taken_s = seconds_since(start);
  static_cast<Seen&>(seen) = seen_in(history);
  seen.goodput_hz = (seen.asked_n - seen.failed_n) / taken_s;
  seen.goodput_share = seen.goodput_hz / seen.peak_hz;
  const int answered_n = answers_n(health_of(server->data_endpoint)) - before_n;
  seen.silent_n = seen.asked_n - answered_n;
  return seen;
}

QuietCell quiet_cell(int requests_n) {
  const auto server = start_server(1);
  History noisy_history;
  std::vector<std::unique_ptr<ClosedLoop>> noisy;
  LoadOptions options = cells_of({server->data_endpoint}, 1);
  options.name = "noisy";
  options.in_flight_n = 40;
  options.dispatch.max_attempts_n = 1;
  for (int connection = 0; connection < 4; ++connection) {
    noisy.push_back(std::make_unique<ClosedLoop>(options, noisy_history));
  }
  noisy_history.wait_for(100);
  History history;
  options.name = "quiet";
  options.in_flight_n = 1;
  run_open_loop(options, kQuiet_hz, requests_n, history);
  for (const auto& connection : noisy) connection->stop();
  QuietCell seen;
  static_cast<Seen&>(seen) = seen_in(history);
  seen.noisy = seen_in(noisy_history);
  return seen;
}

std::vector<double> health_ms_while_busy(int probes_n) {
  const auto server = start_server(2);
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 4);
  options.in_flight_n = 2;
  ClosedLoop load(options, history);
  history.wait_for(10);
  client::Client probe({server->control_endpoint});
  (void)probe.health();  // connected from here on
  std::vector<double> times_ms;
  while (static_cast<int>(times_ms.size()) < probes_n) {
    const TimePoint start = Clock::now();
    const auto health = probe.health().at(0).health;
    const double taken_ms = seconds_since(start) * 1000;
    if (!health) throw std::runtime_error(health.error().message);
    if (health->workers_busy_n == 2) times_ms.push_back(taken_ms);
  }
  std::sort(times_ms.begin(), times_ms.end());
  return times_ms;
}

double plans_hz(int workers_n, std::size_t requests_n) {
  const auto server = start_server(workers_n);
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 2 * workers_n);
  options.script = "spin_20";
  ClosedLoop load(options, history);
  history.wait_for(10);
  const TimePoint start = Clock::now();
  history.wait_for(requests_n);
  return static_cast<double>(requests_n) / seconds_since(start);
}

double front_cpu_ms(std::size_t requests_n) {
  const auto server = start_server(1);
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 1);
  options.script = "echo";
  ClosedLoop load(options, history);
  history.wait_for(10);
  const double before_ms = cpu_ms(server->pid());
  history.wait_for(requests_n);
  return (cpu_ms(server->pid()) - before_ms) / static_cast<double>(requests_n);
}

}  // namespace graspd::trials
