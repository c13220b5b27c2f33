/// What the clients of a service see while it is loaded, killed and restarted: the figures of
/// server/service/PROMISES.md.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "graspd/command_line/run_program.hpp"
#include "graspd/trials/trials.hpp"

namespace graspd::bench {
namespace {

struct Options {
  std::filesystem::path out = "build/bench";
  int requests_n = 1000;
  int soak_s = 120;
  std::vector<std::string> only;  ///< groups of trials; none: all
};

class Table {
 public:
  void add(const std::string& name, double value, const std::string& target) {
    figures_[name] = value;
    fmt::print("{:<24} {:>10.3f}   {}\n", name, value, target);
    std::fflush(stdout);
  }
  void add(const std::string& trial, const trials::Seen& seen) {
    fmt::print("  {}: {} asked: {}\n", trial, seen.asked_n, seen.ended);
    for (const std::string& violation : seen.violations) fmt::print("  BROKEN {}\n", violation);
    violations_n_ += seen.violations.size();
  }
  void write(const std::filesystem::path& folder) {
    figures_["violations"] = violations_n_;
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "service.json") << figures_.dump(2) << "\n";
    std::ofstream csv(folder / "service.csv");
    csv << "figure,value\n";
    for (const auto& [name, value] : figures_.items()) csv << name << "," << value << "\n";
  }
  bool is_clean() const { return violations_n_ == 0; }

 private:
  nlohmann::ordered_json figures_;
  std::size_t violations_n_ = 0;
};

void measure_deaths(std::size_t requests_n, Table& table) {
  const trials::Seen killed = trials::kill_one_of_two_servers(requests_n);
  table.add("kill -9 of one of two servers", killed);
  table.add("kill9_failed", killed.failed_n, "0");
  table.add("kill9_worst_ms", killed.worst_ms, "at most 300");

  const trials::Seen workers = trials::kill_workers(requests_n / 10, 10);
  table.add("kill -9 of ten workers", workers);
  table.add("worker_kill_failed", workers.failed_n, "at most 10, one each");

  const trials::RollingRestart restart = trials::rolling_restart(requests_n / 2);
  table.add("rolling restart of two servers", restart);
  table.add("rolling_failed", restart.failed_n, "0");
  table.add("rolling_stop_s", restart.longest_stop_s, "at most 12");
}

void measure_network(std::size_t requests_n, Table& table) {
  const trials::Seen seen = trials::faults_in_turn(requests_n, 100);
  table.add("100 faults of the network", seen);
  table.add("network_asked", seen.asked_n, "");
  table.add("network_failed", seen.failed_n, "0");
  table.add("network_worst_ms", seen.worst_ms, "");

  const trials::OncePerId once = trials::computations_per_id(20);
  table.add("20 resets of one server's connections", once);
  table.add("computed_at_once", once.at_once_n, "0");
  table.add("computed_again", once.again_n, "");

  const std::string why_not = trials::why_no_namespaces();
  if (!why_not.empty()) fmt::print("  skipped: {}\n", why_not);
  for (const auto& [fault, name] : EnumNames<trials::LinkFault>::values) {
    if (!why_not.empty()) break;
    const trials::Seen link = trials::one_of_two_links_is_bad(fault, std::chrono::seconds(5));
    table.add(fmt::format("link {} to one of two servers", name), link);
    table.add(fmt::format("link_{}_failed", name), link.failed_n, "0");
    table.add(fmt::format("link_{}_worst_ms", name), link.worst_ms, "at most 600");
  }
  if (!why_not.empty()) return;
  const trials::Seen both =
      trials::both_links_are_bad(trials::LinkFault::kLoss5, std::chrono::seconds(20));
  table.add("links to both servers lose 5 %", both);
  table.add("both_links_failed", both.failed_n, "");
  table.add("both_links_worst_ms", both.worst_ms, "at most 5100");
}

void measure_load(int requests_n, Table& table) {
  for (const double share : {0.3, 0.6, 0.8, 0.9, 1.2}) {
    const trials::OpenLoop open = trials::open_loop(share, requests_n / 2);
    table.add(fmt::format("{:.0f} % of capacity", 100 * share), open);
    table.add(fmt::format("open_{:.0f}_p99_ms", 100 * share), open.p99_ms,
              share <= 0.8 ? "at most 40" : "");
  }
  const trials::OpenLoop overload = trials::open_loop(2, 2 * requests_n);
  table.add("200 % of capacity", overload);
  table.add("overload_goodput_share", overload.goodput_share, "at least 0.95");
  table.add("overload_silent", overload.silent_n, "0");

  const trials::QuietCell quiet = trials::quiet_cell(requests_n / 5);
  table.add("a quiet cell", quiet);
  table.add("beside a noisy one", quiet.noisy);
  table.add("quiet_p50_ms", quiet.p50_ms, "at most 60");
  table.add("quiet_max_ms", quiet.worst_ms, "at most 100");

  const std::vector<double> health_ms = trials::health_ms_while_busy(requests_n);
  table.add("health_p50_ms", health_ms[health_ms.size() / 2], "");
  table.add("health_max_ms", health_ms.back(), "at most 10");
}

void measure_crowds(std::size_t requests_n, Table& table) {
  using trials::CrowdKind;
  for (const auto& [kind, name] :
       {std::pair{CrowdKind::kSilent, "silent"}, std::pair{CrowdKind::kStalled, "stalled"}}) {
    const trials::Crowd crowd = trials::beside_a_crowd(kind, 1000, requests_n);
    table.add(fmt::format("a client beside 1000 {} peers", name), crowd);
    table.add(fmt::format("{}_failed", name), crowd.failed_n, "0");
    table.add(fmt::format("{}_p99_ratio", name), crowd.p99_ms / crowd.alone_p99_ms, "at most 1.2");
  }
}

void measure_keys(std::size_t requests_n, Table& table) {
  const trials::RevokedKey revoked = trials::revoke_a_key(requests_n);
  table.add("beside a cell whose key is revoked", revoked);
  table.add("revoked_others_failed", revoked.failed_n, "0");
  table.add("revoked_answered", revoked.ok_after_n, "0");
}

void measure_soak(std::chrono::seconds length, Table& table) {
  const trials::Soak soak = trials::soak(length, std::chrono::seconds(20));
  table.add(fmt::format("{} s at 70 %, {} faults", length.count(), soak.faults_n), soak);
  table.add("soak_failed", soak.failed_n, "0");
  if (soak.memory_mb.empty()) return;
  table.add("soak_memory_begin_mb", soak.memory_mb.front(), "");
  table.add("soak_memory_half_way_mb", soak.memory_mb[soak.memory_mb.size() / 2], "");
  table.add("soak_memory_end_mb", soak.memory_mb.back(), "as at the beginning");
}

void measure_cost(std::size_t requests_n, Table& table) {
  const trials::Overhead overhead = trials::overhead(static_cast<int>(2 * requests_n));
  table.add("overhead_plain_p50_ms", overhead.plain_p50_ms, "at most 0.4");
  table.add("overhead_curve_p50_ms", overhead.curve_p50_ms, "at most 1.5");
  const double one_hz = trials::plans_hz(1, requests_n / 2);
  const double two_hz = trials::plans_hz(2, requests_n / 2);
  table.add("one_worker_hz", one_hz, "");
  table.add("two_worker_hz", two_hz, "");
  table.add("two_worker_speedup", two_hz / one_hz, "at least 1.8");
  table.add("front_cpu_ms", trials::front_cpu_ms(2 * requests_n), "at most 0.3");
}

using Groups =
    std::vector<std::pair<std::string, std::function<void(const Options& options, Table& table)>>>;

/// The trials by the names that `--only` takes, in the order in which they run.
const Groups& groups() {
  const auto by_requests = [](void (*measure)(std::size_t, Table&)) {
    return [measure](const Options& options, Table& table) {
      measure(static_cast<std::size_t>(options.requests_n), table);
    };
  };
  static const Groups kGroups{
      {"deaths", by_requests(measure_deaths)},
      {"network", by_requests(measure_network)},
      {"load", [](const Options& o, Table& table) { measure_load(o.requests_n, table); }},
      {"crowds", by_requests(measure_crowds)},
      {"keys", by_requests(measure_keys)},
      {"cost", by_requests(measure_cost)},
      {"soak", [](const Options& o, Table& table) {
         measure_soak(std::chrono::seconds(o.soak_s), table);
       }}};
  return kGroups;
}

std::vector<std::string> group_names() {
  std::vector<std::string> names;
  for (const auto& [name, measure] : groups()) names.push_back(name);
  return names;
}

int measure(const Options& options) {
  Table table;
  for (const auto& [name, measure] : groups()) {
    if (options.only.empty() || std::ranges::count(options.only, name) > 0) measure(options, table);
  }
  table.write(options.out);
  return table.is_clean() ? 0 : 1;
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  graspd::bench::Options options;
  return graspd::run_program("bench_service", count, words, [&](CLI::App& app) {
    app.description("What the clients of a service see while it is loaded, killed and restarted.");
    app.add_option("--out", options.out, "folder for service.json and service.csv")
        ->capture_default_str();
    app.add_option("--requests", options.requests_n, "the length of a trial")
        ->check(CLI::Range(100, 1'000'000))
        ->capture_default_str();
    app.add_option("--soak-s", options.soak_s, "the length of the soak in seconds")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    app.add_option("--only", options.only, "these trials alone, and no others")
        ->check(CLI::IsMember(graspd::bench::group_names()));
    app.callback([&] {
      if (const int code = graspd::bench::measure(options)) throw CLI::RuntimeError(code);
    });
  });
}
