#include <filesystem>
#include <fstream>
#include <thread>

#include "graspd/trials/chaos_proxy.hpp"
#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kSoakSeed = 11;
// 70 % of what one server with two workers of 20 ms can do, since the other's network may stall.
constexpr double kLoad_hz = 0.7 * 100;

double resident_mb(pid_t pid) {
  std::ifstream statm("/proc/" + std::to_string(pid) + "/statm");
  double size_pages = 0;
  double resident_pages = 0;
  statm >> size_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// Of the front and its workers.
double memory_mb(const testing::ServeProcess& server) {
  double sum_mb = resident_mb(server.pid());
  for (const pid_t worker : server.workers()) sum_mb += resident_mb(worker);
  return sum_mb;
}

void change(int fault, ChaosProxy& network, const testing::ServeProcess& server) {
  Chaos chaos;
  if (fault == 0) chaos.delay = milliseconds(3);
  if (fault == 1) chaos.stalled = true;
  if (fault == 2) chaos.chop_bytes = 5000;
  network.set(chaos);
  if (fault == 3) network.reset_connections();
  if (fault == 4) server.kill(SIGHUP);
}

}  // namespace

Soak soak(std::chrono::milliseconds length, std::chrono::milliseconds fault_every) {
  const Keyring keys(
      {"cell_0", "cell_1", "cell_2", "cell_3", "cell_4", "cell_5", "cell_6", "cell_7"});
  const auto first = start_server(2, {}, &keys);
  const auto second = start_server(2, {}, &keys);
  ChaosProxy networks[]{{first->data_endpoint, kSoakSeed}, {second->data_endpoint, kSoakSeed}};
  Soak seen;
  const std::size_t descriptors_at_rest_n = descriptors_n(second->pid());
  History history;
  {
    LoadOptions options = cells_of({networks[0].endpoint(), networks[1].endpoint()}, 8);
    options.keys = keys.of_cells();
    options.dispatch.attempt_timeout = milliseconds(500);
    const double length_s = std::chrono::duration<double>(length).count();
    std::thread load(
        [&] { run_open_loop(options, kLoad_hz, static_cast<int>(kLoad_hz * length_s), history); });
    const TimePoint start = Clock::now();
    for (seen.faults_n = 0; (seen.faults_n + 1) * fault_every < length; ++seen.faults_n) {
      std::this_thread::sleep_until(start + (seen.faults_n + 1) * fault_every);
      const int server = seen.faults_n / 5 % 2;
      change(seen.faults_n % 5, networks[server], server == 0 ? *first : *second);
      seen.memory_mb.push_back(memory_mb(*first) + memory_mb(*second));
    }
    load.join();
  }
  // Its clients are gone; it hears of that from the system.
  while (descriptors_n(second->pid()) > descriptors_at_rest_n) std::this_thread::yield();
  static_cast<Seen&>(seen) = seen_in(history);
  return seen;
}

}  // namespace graspd::trials
