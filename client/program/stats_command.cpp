#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/command_line/help.hpp"
#include "server_arguments.hpp"
#include "stats_report.hpp"

namespace graspd::program {
namespace {

using std::chrono::milliseconds;

constexpr const char* kClearTerminal = "\033[H\033[2J";

struct StatsArguments {
  ServerArguments servers;
  int interval_ms = 1000;
  int budget_ms = 2000;
  bool once = false;
};

Result<int> show(const StatsArguments& arguments) {
  auto options = client_options(arguments.servers);
  if (!options) return tl::unexpected(options.error());
  client::Client client(arguments.servers.servers, *std::move(options));
  const milliseconds budget(arguments.budget_ms);
  if (arguments.once) {
    const auto servers = client.health(budget);
    fmt::print("{}", stats_report({}, servers));
    for (const auto& server : servers) {
      if (!server.health) print_error(server.health.error());
    }
    const bool all = std::all_of(servers.begin(), servers.end(),
                                 [](const auto& server) { return server.health.has_value(); });
    return all ? 0 : kExitTryAgain;
  }
  const char* const before_table = isatty(STDOUT_FILENO) != 0 ? kClearTerminal : "\n";
  auto before = client.health(budget);
  while (true) {
    std::this_thread::sleep_for(milliseconds(arguments.interval_ms));
    auto now = client.health(budget);
    fmt::print("{}{}", before_table, stats_report(before, now));
    if (std::fflush(stdout) != 0) return 0;  // nobody reads any more
    before = std::move(now);
  }
}

}  // namespace

void add_stats_command(CLI::App& app) {
  const auto arguments = std::make_shared<StatsArguments>();
  CLI::App* command = app.add_subcommand("stats", "watch what servers do, until Ctrl-C");
  add_server_options(*command, arguments->servers);
  command->add_option("--interval-ms", arguments->interval_ms, "between two looks")
      ->check(CLI::Range(100, 3'600'000))
      ->capture_default_str();
  command->add_option("--budget-ms", arguments->budget_ms, "how long to wait for an answer")
      ->check(CLI::Range(1, 600'000))
      ->capture_default_str();
  command->add_flag("--once", arguments->once, "one table of all since the servers started");
  set_help(*command,
           "shed: BUSY, SUPERSEDED, DEADLINE_EXCEEDED, DRAINING, which more servers would have "
           "served; broken: INTERNAL and REJECTED_POISON, defects; refused: the client's mistakes. "
           "MiB: memory of the server and its workers.",
           {"grasp stats --server tcp://127.0.0.1:5555 --once"});
  command->callback([arguments] { finish(show(*arguments)); });
}

}  // namespace graspd::program
