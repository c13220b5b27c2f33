#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/client/client.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/formats/table.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

struct HealthArguments {
  ServerArguments servers;
  int budget_ms = 2000;
  bool json = false;
};

std::vector<std::string> row_of(const std::string& endpoint, const HealthAnswer& health) {
  return {endpoint,
          std::string(name_of(health.state)),
          std::to_string(health.workers_n),
          std::to_string(health.workers_busy_n),
          std::to_string(health.queued_n),
          std::to_string(health.answered_n),
          fmt::format("{:.0f}", health.uptime_s),
          fmt::format("{}", fmt::join(health.part_ids, " ")),
          health.server.build};
}

Result<int> ask(const HealthArguments& arguments) {
  auto options = client_options(arguments.servers);
  if (!options) return tl::unexpected(options.error());
  client::Client client(arguments.servers.servers, *std::move(options));
  Table table(
      {"server", "state", "workers", "busy", "queued", "answered", "up s", "parts", "build"});
  int code = 0;
  bool any = false;
  for (const auto& [endpoint, health] :
       client.health(std::chrono::milliseconds(arguments.budget_ms))) {
    if (!health) {
      print_error(health.error());
      code = exit_code(health.error().code);
      continue;
    }
    any = true;
    if (health->state != ServerState::kReady) code = kExitTryAgain;
    if (arguments.json) {
      fmt::print("{}\n", codec::to_json(*health, false));
    } else {
      table.add(row_of(endpoint, *health));
    }
  }
  if (any && !arguments.json) fmt::print("{}", table.to_text());
  return code;
}

}  // namespace

void add_health_command(CLI::App& app) {
  const auto arguments = std::make_shared<HealthArguments>();
  CLI::App* command = app.add_subcommand("health", "ask servers how they are");
  add_server_options(*command, arguments->servers);
  command->add_option("--budget-ms", arguments->budget_ms, "how long to wait")
      ->check(CLI::Range(1, 600'000))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one line of JSON per server");
  set_help(*command, "", {"grasp health --server tcp://127.0.0.1:5555"});
  command->callback([arguments] { finish(ask(*arguments)); });
}

}  // namespace graspd::program
