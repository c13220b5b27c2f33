#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/installed.hpp"
#include "graspd/console/console.hpp"
#include "server_arguments.hpp"

namespace graspd::program {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kHealthBudget{900};

struct ConsoleArguments {
  ServerArguments servers;
  console::ConsoleOptions options;
  std::string listen = "127.0.0.1:8080";
  bool expose = false;
};

/// Beside the program, installed or built.
fs::path page_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share/graspd/console";
}

Result<void> read_listen(const ConsoleArguments& arguments, console::ConsoleOptions& options) {
  const std::string& listen = arguments.listen;
  const std::size_t colon = listen.rfind(':');
  const std::string port = colon == std::string::npos ? "" : listen.substr(colon + 1);
  const bool is_number = !port.empty() && port.size() <= 5 &&
                         port.find_first_not_of("0123456789") == std::string::npos;
  if (!is_number || colon == 0 || std::stoi(port) > 65535) {
    return invalid("--listen {}: say it as HOST:PORT, like 127.0.0.1:8080", listen);
  }
  options.host = listen.substr(0, colon);
  options.port = std::stoi(port);
  if (console::is_loopback(options.host) || arguments.expose) return {};
  return invalid(
      "--listen {}: the console asks nobody for a password, so it stays on this machine. From "
      "another,\n`ssh -L 8080:127.0.0.1:8080 THIS_MACHINE` and open http://localhost:8080; or put "
      "a web server\nwith a login in front. --expose shows it to everybody in the network.",
      listen);
}

Result<int> serve(const ConsoleArguments& arguments) {
  console::ConsoleOptions options = arguments.options;
  if (auto ok = read_listen(arguments, options); !ok) return tl::unexpected(ok.error());
  options.page = page_folder();
  if (!fs::exists(options.page / "index.html")) {
    return invalid(
        "{}: the console's page was not built, for want of npm. Run `deploy/install-deps "
        "--console`\nand `./run build`; graspd-client from `./run package` has it.",
        options.page.string());
  }
  // Frames go back to the system as soon as they were sent, whichever thread had them.
  mallopt(M_MMAP_THRESHOLD, 128 * 1024);
  // Before any thread is: they all leave these signals to us.
  sigset_t end;
  sigemptyset(&end);
  sigaddset(&end, SIGINT);
  sigaddset(&end, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &end, nullptr);
  auto client_settings = client_options(arguments.servers);
  if (!client_settings) return tl::unexpected(client_settings.error());
  const auto client =
      std::make_shared<client::Client>(arguments.servers.servers, *std::move(client_settings));
  options.ask_servers = [client] { return client->health(kHealthBudget); };

  const auto console = console::Console::start(std::move(options));
  if (!console) return tl::unexpected(console.error());
  fmt::print("The console is at {}\n", console->url());
  std::fflush(stdout);
  int signal = 0;
  sigwait(&end, &signal);
  return 0;
}

}  // namespace

void add_console_command(CLI::App& app) {
  const auto arguments = std::make_shared<ConsoleArguments>();
  CLI::App* command =
      app.add_subcommand("console", "a web page of cells, plans and picks, until Ctrl-C");
  command
      ->add_option("--flights", arguments->options.flights,
                   "a server's flight recorder, with 'keep: all'; say it once per server")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--records", arguments->options.records,
                   "agents' records: verdicts and times; say it once per folder")
      ->type_name("DIR");
  arguments->options.parts = installed("usr/share/graspd/parts");
  CLI::Option* parts = command->add_option("--parts", arguments->options.parts,
                                           "the part catalogue, for the parts' shapes");
  parts->type_name("DIR");
  if (arguments->options.parts.empty()) {
    parts->required();
  } else {
    parts->capture_default_str();
  }
  add_server_options(*command, arguments->servers);
  command->add_option("--listen", arguments->listen, "where browsers find it; port 0: a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  command->add_flag("--expose", arguments->expose,
                    "let other machines look, though nobody is asked for a password");
  set_help(*command,
           "It shows what others write, and writes nothing: --flights is the folder of "
           "flight_recorder in server.yaml, --records what agents call 'records'. It listens on "
           "this machine alone; from another, `ssh -L 8080:127.0.0.1:8080`.",
           {"grasp console --flights build/flights --parts deploy/parts"});
  command->callback([arguments] { finish(serve(*arguments)); });
}

}  // namespace graspd::program
