#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "graspd/client/client.hpp"

namespace graspd::program {

/// Which servers, and who asks: the same options for every command that talks to servers.
struct ServerArguments {
  std::vector<std::string> servers{"tcp://127.0.0.1:5555"};
  std::string server_key;
  std::string key;
};

/// `--server` alone.
void add_server_option(CLI::App& command, std::vector<std::string>& servers);
void add_server_options(CLI::App& command, ServerArguments& arguments);

/// With the keys read, in the name of the cell that they belong to; without keys in that of
/// "grasp".
Result<client::ClientOptions> client_options(const ServerArguments& arguments);

}  // namespace graspd::program
