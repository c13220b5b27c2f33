#include "server_arguments.hpp"

namespace graspd::program {

void add_server_options(CLI::App& command, ServerArguments& arguments) {
  command.add_option("--server", arguments.servers, "endpoint; say it once per server")
      ->type_name("tcp://HOST:PORT")
      ->capture_default_str();
}

}  // namespace graspd::program
