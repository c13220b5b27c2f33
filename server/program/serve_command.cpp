#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/signalfd.h>
#include <tbb/global_control.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <system_error>

#include "commands.hpp"
#include "graspd/command_line/choices.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/installed.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/service/front.hpp"
#include "graspd/service/private_directory.hpp"
#include "planner.hpp"
#include "refuse.hpp"
#include "systemd_notifier.hpp"

namespace graspd::program {
namespace {

constexpr int kExitCannotListen = 3;

struct ServeArguments {
  std::string config;
  std::optional<std::string> parts;
  std::optional<std::string> data_endpoint;
  std::optional<std::string> control_endpoint;
  std::optional<std::string> http_endpoint;
  std::optional<std::uint32_t> workers_n;
  std::optional<std::string> log_level;
  std::optional<std::string> key_file;
  std::optional<std::string> allowed_cells;
  bool insecure = false;
};

/// What the file says, changed by the command line.
Result<service::ServerConfig> configure(const ServeArguments& arguments) {
  service::ServerConfig config;
  if (!arguments.config.empty()) {
    auto read = service::read_config(arguments.config);
    if (!read) return read;
    config = *std::move(read);
  }
  if (arguments.parts) config.parts = *arguments.parts;
  if (arguments.data_endpoint) config.data_endpoint = *arguments.data_endpoint;
  if (arguments.control_endpoint) config.control_endpoint = *arguments.control_endpoint;
  if (arguments.http_endpoint) config.http_endpoint = *arguments.http_endpoint;
  if (arguments.workers_n) config.workers_n = *arguments.workers_n;
  if (arguments.log_level) {
    config.log_level = parse_enum<service::LogLevel>(*arguments.log_level).value();
  }
  if (arguments.key_file) config.key_file = *arguments.key_file;
  if (arguments.allowed_cells) config.allowed_cells = *arguments.allowed_cells;
  if (arguments.insecure) config.insecure = true;
  config.parts = std::filesystem::absolute(config.parts);
  if (auto ok = service::validate(config); !ok) return tl::unexpected(ok.error());
  return config;
}

/// Signals as a descriptor. Blocked from here on, in every thread that starts later.
int signal_descriptor(std::initializer_list<int> numbers) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : numbers) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  const int fd = signalfd(-1, &signals, SFD_CLOEXEC);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
  return fd;
}

service::Log make_log(service::LogLevel least) {
  const auto logger = spdlog::stderr_logger_mt("grasp_server");
  // A line is a JSON object; what comes in is the rest of one, after its brace.
  logger->set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l",%v)");
  logger->set_level(spdlog::level::trace);
  logger->flush_on(spdlog::level::trace);
  return [logger, least](service::LogLevel level, std::string_view object) {
    if (level < least) return;
    const std::string_view line = object.substr(1);
    switch (level) {
      case service::LogLevel::kDebug:
        logger->debug("{}", line);
        break;
      case service::LogLevel::kInfo:
        logger->info("{}", line);
        break;
      case service::LogLevel::kWarning:
        logger->warn("{}", line);
        break;
      case service::LogLevel::kError:
        logger->error("{}", line);
        break;
      case service::LogLevel::kOff:
        break;
    }
  };
}

/// The configuration that workers read: what is in force here, even if the file changes meanwhile.
std::filesystem::path write_effective_config(const service::ServerConfig& config,
                                             const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "server.yaml";
  const std::filesystem::path beside = folder / "server.yaml.new";
  std::ofstream file(beside);
  file << service::to_yaml(config) << std::flush;
  if (!file) throw std::runtime_error(fmt::format("{}: can't be written", beside.string()));
  std::filesystem::rename(beside, path);  // a worker that starts during a reload reads all of it
  return path;
}

std::unique_ptr<service::WorkerLauncher> make_launcher(const service::ServerConfig& config,
                                                       const Planner& planner,
                                                       const std::filesystem::path& folder) {
  if (config.workers_n == 0) {
    return std::make_unique<service::ThreadLauncher>(planner.handler, planner.server,
                                                     planner.golden);
  }
  const std::string effective = write_effective_config(config, folder);
  // This very program, even if its file has been replaced by a newer one.
  return std::make_unique<service::ProcessLauncher>(
      "/proc/self/exe", std::vector<std::string>{"grasp_server", "worker", "--config", effective});
}

Result<std::optional<service::Authentication>> read_keys(const service::ServerConfig& config) {
  if (config.insecure) return std::nullopt;
  auto server = keys::read_key_pair(config.key_file);
  if (!server) return tl::unexpected(server.error());
  auto allowed = keys::AllowList::read(config.allowed_cells);
  if (!allowed) return tl::unexpected(allowed.error());
  return service::Authentication{*std::move(server), *std::move(allowed)};
}

int serve(const ServeArguments& arguments) {
  // Before any file is read: a signal that comes meanwhile is not lost, and kills nobody.
  const int stop_fd = signal_descriptor({SIGTERM, SIGINT});
  const int reload_fd = signal_descriptor({SIGHUP});
  const auto config = configure(arguments);
  if (!config) return refuse(config.error());
  const auto authentication = read_keys(*config);
  if (!authentication) return refuse(authentication.error());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    threads_per_worker(*config));
  auto planner = make_planner(*config);
  if (!planner) return refuse(planner.error());
  const service::PrivateDirectory folder;
  const auto launcher = make_launcher(*config, *planner, folder.path());

  service::FrontOptions options;
  options.config = *config;
  options.facts = {planner->part_ids, planner->server};
  options.worker_endpoint = "ipc://" + (folder.path() / "workers").string();
  options.authentication = *authentication;
  options.stop_fd = stop_fd;
  options.reload_fd = reload_fd;
  options.load_parts = [&]() -> Result<service::NewParts> {
    const auto loaded = make_planner(*config);
    if (!loaded) return tl::unexpected(loaded.error());
    return service::NewParts{{loaded->part_ids, loaded->server},
                             make_launcher(*config, *loaded, folder.path())};
  };
  options.log = make_log(config->log_level);
  SystemdNotifier systemd;
  options.on_turn = [&systemd](service::Phase phase) { systemd.tell(phase); };
  service::Front* running = nullptr;
  options.on_ready = [&] {
    const std::string http = running->http_url();
    fmt::print("grasp_server ready: data {}, control {}, {} parts, {} workers{}\n",
               running->data_endpoint(), running->control_endpoint(), planner->part_ids.size(),
               config->workers_n, http.empty() ? "" : ", metrics " + http + "/metrics");
    std::fflush(stdout);
  };
  try {
    service::Front front(options, *launcher);
    running = &front;
    front.run();
  } catch (const service::CannotListen& error) {
    fmt::print(stderr, "grasp_server: {}\n", error.what());
    return kExitCannotListen;
  }
  return 0;
}

}  // namespace

void add_serve_command(CLI::App& app) {
  const auto arguments = std::make_shared<ServeArguments>();
  arguments->config = installed("etc/graspd/server.yaml");
  CLI::App* command = app.add_subcommand("serve", "serve plan requests over the network");
  command
      ->add_option("--config", arguments->config,
                   "configuration; deploy/server.yaml explains it, and an installed server has it "
                   "in /etc/graspd")
      ->type_name("FILE");
  command->add_option("--parts", arguments->parts, "folder of the part catalogue")
      ->type_name("DIR");
  command->add_option("--endpoint", arguments->data_endpoint, "where plans are asked")
      ->type_name("tcp://HOST:PORT");
  command->add_option("--control-endpoint", arguments->control_endpoint, "where health is asked")
      ->type_name("tcp://HOST:PORT");
  command
      ->add_option("--http-endpoint", arguments->http_endpoint,
                   "where /metrics, /livez and /readyz are asked")
      ->type_name("tcp://HOST:PORT");
  command
      ->add_option("--workers", arguments->workers_n, "worker processes; 0: none, plan in-process")
      ->type_name("N");
  command->add_option("--log-level", arguments->log_level, "the least that is logged")
      ->check(one_of<service::LogLevel>())
      ->type_name("LEVEL");
  command->add_option("--key", arguments->key_file, "the server's own key")->type_name("FILE");
  command->add_option("--allowed-cells", arguments->allowed_cells, "list of who may ask")
      ->type_name("FILE");
  command->add_flag("--insecure", arguments->insecure,
                    "let everybody on this machine ask, without keys; loopback only");
  set_help(*command,
           "Prints 'grasp_server ready: data ENDPOINT, control ENDPOINT, …' on its output when it "
           "is, logs to its error output, and ends on SIGTERM or Ctrl-C after finishing what it "
           "accepted; at once on the second. SIGHUP reads the list of allowed cells and the parts "
           "again while it goes on serving.",
           {"grasp_server serve --config deploy/server.yaml --insecure --workers 2"});
  command->callback([arguments] {
    if (const int code = serve(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::program
