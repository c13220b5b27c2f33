#include <tbb/global_control.h>

#include <memory>
#include <stdexcept>

#include "commands.hpp"
#include "planner.hpp"

namespace graspd::program {
namespace {

struct WorkerArguments {
  std::string config;
  service::WorkerOptions worker;
};

void run(const WorkerArguments& arguments) {
  const auto config = service::read_config(arguments.config);
  if (!config) throw std::runtime_error(config.error().message);
  service::prepare_worker_process(config->worker_memory_limit_mib);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    threads_per_worker(*config));
  const auto planner = make_planner(*config);
  if (!planner) throw std::runtime_error(planner.error().message);
  service::WorkerOptions options = arguments.worker;
  options.server = planner->server;
  options.golden = planner->golden;
  service::run_worker(options, planner->handler);
}

}  // namespace

void add_worker_command(CLI::App& app) {
  const auto arguments = std::make_shared<WorkerArguments>();
  CLI::App* command = app.add_subcommand("worker", "one worker process; started by serve");
  command->group("");  // not for people
  command->add_option("--config", arguments->config)->required();
  command->add_option("--endpoint", arguments->worker.endpoint)->required();
  command->add_option("--identity", arguments->worker.identity)->required();
  command->callback([arguments] { run(*arguments); });
}

}  // namespace graspd::program
