/// What clients see of a fleet behind HAProxy and of one on Slurm, while a server or a node is
/// lost.
#include "graspd/trials/fleet.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "graspd/command_line/run_program.hpp"

namespace graspd::bench {
namespace {

void need(const std::string& why_not) {
  if (!why_not.empty()) throw std::runtime_error(why_not);
}

void say(const std::string& trial, const trials::Seen& seen) {
  fmt::print("{:<28} {:>6} asked, {} failed ({}), median {:.1f} ms, worst {:.0f} ms\n", trial,
             seen.asked_n, seen.failed_n, seen.ended, seen.p50_ms, seen.worst_ms);
  for (const std::string& violation : seen.violations) fmt::print("  BROKEN {}\n", violation);
  std::fflush(stdout);
}

void measure(const std::filesystem::path& out, std::size_t requests_n) {
  need(trials::why_no_haproxy());
  need(trials::why_no_slurm());
  const trials::BehindHaproxy haproxy = trials::kill_one_server_behind_haproxy(requests_n);
  say("HAProxy, a server killed", haproxy);
  const trials::OnSlurm slurm = trials::lose_a_slurm_node(requests_n);
  say("Slurm, a node lost", slurm);
  fmt::print("  its server was back on another node after {:.0f} s\n", slurm.lost_until_back_s);

  const nlohmann::ordered_json figures{
      {"haproxy_asked", haproxy.asked_n},
      {"haproxy_failed", haproxy.failed_n},
      {"haproxy_worst_ms", haproxy.worst_ms},
      {"slurm_asked", slurm.asked_n},
      {"slurm_failed", slurm.failed_n},
      {"slurm_worst_ms", slurm.worst_ms},
      {"slurm_back_s", slurm.lost_until_back_s},
      {"violations", haproxy.violations.size() + slurm.violations.size()}};
  std::filesystem::create_directories(out);
  std::ofstream(out / "fleet.json") << figures.dump(2) << "\n";
  std::ofstream csv(out / "fleet.csv");
  csv << "figure,value\n";
  for (const auto& [name, value] : figures.items()) csv << name << "," << value << "\n";
}

}  // namespace
}  // namespace graspd::bench

int main(int count, char** words) {
  std::filesystem::path out = "build/bench";
  std::size_t requests_n = 1000;
  return graspd::run_program("bench_fleet", count, words, [&](CLI::App& app) {
    app.description("A server lost behind HAProxy, a node lost under Slurm. Needs root.");
    app.add_option("--out", out, "folder for fleet.json and fleet.csv")->capture_default_str();
    app.add_option("--requests", requests_n, "of each phase")
        ->check(CLI::Range(100, 1'000'000))
        ->capture_default_str();
    app.callback([&] { graspd::bench::measure(out, requests_n); });
  });
}
