#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/client/client.hpp"
#include "graspd/codec/codec.hpp"
#include "plan_report.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

struct ReplayArguments {
  ServerArguments servers;
  std::string request;
  int budget_ms = 10'000;
  bool json = false;
};

Result<std::string> read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return invalid("{}: can't be read", path.string());
  return std::string(std::istreambuf_iterator<char>(file), {});
}

codec::Bytes view(const std::string& bytes) { return std::as_bytes(std::span(bytes)); }

Result<int> replay(const ReplayArguments& arguments) {
  const std::filesystem::path path = arguments.request;
  const auto envelope = read_bytes(path);
  if (!envelope) return tl::unexpected(envelope.error());
  const auto payload = read_bytes(std::filesystem::path(path).replace_extension(".depth"));
  if (!payload) return tl::unexpected(payload.error());
  const auto request = codec::decode_request(view(*envelope));
  if (!request) return invalid("{}: {}", path.string(), request.error().message);
  const auto* call = std::get_if<PlanCall>(&request->call);
  if (call == nullptr) return invalid("{}: no plan request", path.string());
  const auto frame = codec::decode_frame(call->frame, view(*payload));
  if (!frame) return invalid("{}: {}", path.string(), frame.error().message);

  auto options = client_options(arguments.servers);
  if (!options) return tl::unexpected(options.error());
  if (!options->keys) options->cell = request->cell;  // a key asks in its own cell's name
  client::Client client(arguments.servers.servers, *std::move(options));
  const auto start = std::chrono::steady_clock::now();
  const auto answer =
      client.plan(*frame, call->plan, std::chrono::milliseconds(arguments.budget_ms));
  if (!answer) return tl::unexpected(answer.error());
  print_plan(*answer, arguments.json, std::chrono::steady_clock::now() - start);
  return exit_code(answer->outcome);
}

}  // namespace

void add_replay_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      app.add_subcommand("replay", "send a request again that a server has recorded");
  command->add_option("request", arguments->request, "ID.request; ID.depth is beside it")
      ->type_name("FILE")
      ->required();
  add_server_options(*command, arguments->servers);
  command->add_option("--budget-ms", arguments->budget_ms, "how long to wait for the answer")
      ->check(CLI::Range(1, 3'600'000))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "print the whole answer as JSON");
  command->footer(
      "A server records requests that failed where its configuration says record_failed.\n\n"
      "Example: grasp replay failed/0123456789abcdef0123456789abcdef.request");
  command->callback([arguments] { finish(replay(*arguments)); });
}

}  // namespace graspd::program
