#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace graspd::program {

/// Which servers: the same option for every command that talks to them.
struct ServerArguments {
  std::vector<std::string> servers{"tcp://127.0.0.1:5555"};
};

void add_server_options(CLI::App& command, ServerArguments& arguments);

}  // namespace graspd::program
