#include "server_arguments.hpp"

namespace graspd::program {

void add_server_option(CLI::App& command, std::vector<std::string>& servers) {
  command
      .add_option("--server", servers,
                  "endpoint; say it once per server, or a name that has the addresses of all")
      ->type_name("tcp://HOST:PORT")
      ->capture_default_str();
}

void add_server_options(CLI::App& command, ServerArguments& arguments) {
  add_server_option(command, arguments.servers);
  CLI::Option* server_key = command.add_option("--server-key", arguments.server_key,
                                               "the servers' public key; none: they are insecure");
  CLI::Option* key =
      command.add_option("--key", arguments.key, "the cell's own key, from 'grasp keys new'");
  server_key->type_name("FILE.pub")->needs(key);
  key->type_name("FILE.key")->needs(server_key);
}

Result<client::ClientOptions> client_options(const ServerArguments& arguments) {
  client::ClientOptions options;
  options.cell = "grasp";
  if (arguments.key.empty()) return options;
  auto keys = keys::read_client_keys(arguments.server_key, arguments.key);
  if (!keys) return tl::unexpected(keys.error());
  options.cell = keys->own.cell;
  options.keys = *std::move(keys);
  return options;
}

}  // namespace graspd::program
