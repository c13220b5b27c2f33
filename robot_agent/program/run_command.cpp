#include <spdlog/spdlog.h>

#include <cstdio>

#include "cell_config.hpp"
#include "cell_frames.hpp"
#include "cell_request.hpp"
#include "commands.hpp"
#include "console_operator.hpp"
#include "equipment.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/server_planner/server_planner.hpp"
#include "report.hpp"
#include "signals.hpp"

namespace graspd::robot_agent {
namespace {

/// What the command line may say over the configuration.
struct RunArguments {
  std::filesystem::path config;
  std::filesystem::path output = ".";
  std::string cell;
  std::vector<std::string> servers;
  std::filesystem::path recording;
  std::optional<std::uint32_t> frames_n;
  std::optional<std::uint32_t> pile_n;
  std::optional<std::uint32_t> seed;
  bool no_header = false;
};

Result<CellConfig> configure(const RunArguments& arguments) {
  auto config = read_cell_config(arguments.config, arguments.output);
  if (!config) return config;
  if (!arguments.cell.empty()) config->cell = arguments.cell;
  if (!arguments.servers.empty()) config->servers = arguments.servers;
  const bool is_replay = config->camera && config->camera->is_recording();
  if ((!arguments.recording.empty() || arguments.frames_n) && !is_replay) {
    return invalid("--recording and --frames are for a cell that replays a recording");
  }
  if (!arguments.recording.empty()) config->camera->path = arguments.recording;
  if (arguments.frames_n) config->camera->frames_n = *arguments.frames_n;
  auto& pile = config->arm.pile;
  if ((arguments.pile_n || arguments.seed) && !pile) {
    return invalid("--pile and --seed are for a simulated cell");
  }
  if (arguments.pile_n) pile->count_n = *arguments.pile_n;
  if (arguments.seed) pile->seed = *arguments.seed;
  return config;
}

Result<std::unique_ptr<agent::Planner>> make_planner(const CellConfig& config) {
  const std::chrono::milliseconds budget(config.budget_ms);
  if (config.server_key.empty() && config.key_file.empty()) {
    return agent::connect_planner(config.servers, config.cell, budget);
  }
  auto keys = keys::read_client_keys(config.server_key, config.key_file);
  if (!keys) return tl::unexpected(keys.error());
  return agent::connect_planner(config.servers, config.cell, budget, *std::move(keys));
}

Result<agent::Task> make_task(const CellConfig& config, const CellFrames& frames) {
  const auto request = make_request(config, frames);
  if (!request) return tl::unexpected(request.error());
  agent::Task task;
  task.request = *request;
  task.request.options.outlines = !config.overlays.empty();
  task.T_base_place = config.T_base_place;
  task.failed_spot_radius_m = config.failed_spot_radius_m;
  task.retry = config.retry;
  task.drift = config.drift;
  task.reactions = config.reactions;
  task.stir = config.stir;
  if (task.reactions.any(agent::Reaction::kStir) && !task.request.bin) {
    return invalid("reactions: to stir, the agent must know where the bin is; add a bin section");
  }
  return task;
}

/// What the cell does, for its first line in the log.
std::string what_it_does(const CellConfig& config) {
  if (!config.camera) return "picking in simulation";
  if (!config.camera->is_recording()) return "picking";
  return "replaying " + config.camera->path.lexically_normal().string();
}

void pick(const std::string& cell, agent::PickCycle& cycle) {
  while (!cycle.is_over()) {
    if (asked_to_stop()) cycle.finish();
    const agent::State before = cycle.state();
    const agent::State after = cycle.step();
    spdlog::debug("{}: {} -> {}", cell, name_of(before), name_of(after));
  }
}

Result<int> run_cell(const RunArguments& arguments) {
  const auto config = configure(arguments);
  if (!config) return tl::unexpected(config.error());
  const auto frames = find_cell_frames(*config);
  if (!frames) return tl::unexpected(frames.error());
  const auto task = make_task(*config, *frames);
  if (!task) return tl::unexpected(task.error());

  const auto equipment = make_equipment(*config, *frames);
  if (!equipment) return tl::unexpected(equipment.error());
  const auto planner = make_planner(*config);
  if (!planner) return tl::unexpected(planner.error());
  auto recorder = record::RunRecorder::create(
      config->records, config->cell, std::chrono::system_clock::now(), config->keep_frames);
  if (!recorder) return tl::unexpected(recorder.error());

  spdlog::info("{}: planning at {}, {}, recording to {}", config->cell,
               fmt::join(config->servers, ", "), what_it_does(*config),
               recorder->folder().lexically_normal().string());
  Reporter reporter(config->cell, *std::move(recorder), config->overlays);
  ConsoleOperator console_operator;
  agent::PickCycle cycle({*equipment->camera, equipment->timed(**planner), *equipment->arm,
                          *equipment->gripper, *equipment->clock, &console_operator},
                         *task, reporter);
  if (!arguments.no_header) fmt::print("{}\n", report_header());
  std::fflush(stdout);  // above the lines of other agents that share the terminal
  pick(config->cell, cycle);
  reporter.ended(cycle);
  if (auto ok = equipment->finish(); !ok) return tl::unexpected(ok.error());
  return cycle.state() == agent::State::kDone ? kExitDone : kExitFailed;
}

int run(const RunArguments& arguments) {
  listen_for_signals();
  const auto exit_code = run_cell(arguments);
  if (exit_code) return *exit_code;
  const Error& error = exit_code.error();
  spdlog::error("{}", error.message);
  return error.code == Code::kUnavailable ? kExitFailed : kExitWrongInput;
}

}  // namespace

void add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* command =
      app.add_subcommand("run", "pick in a cell until its bin is empty or its recording is over");
  command
      ->add_option("--config", arguments->config,
                   "what the cell is and does; deploy/cells/tees.yaml and anno.yaml explain it")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", arguments->output, "folder for what is written; default: this one")
      ->type_name("DIR");
  command->add_option("--cell", arguments->cell, "the cell's name, not the configuration's")
      ->type_name("NAME");
  command->add_option("--server", arguments->servers, "ask these, not the configuration's")
      ->type_name("tcp://HOST:PORT");
  command->add_option("--recording", arguments->recording, "replay this, not the configuration's")
      ->type_name("PATH");
  command->add_option("--frames", arguments->frames_n, "end after so many frames")->type_name("N");
  command
      ->add_option("--pile", arguments->pile_n,
                   "so many of each part in a simulated cell, not the configuration's")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command
      ->add_option("--seed", arguments->seed, "of a simulated cell's pile, not the configuration's")
      ->type_name("N");
  command->add_flag("--no-header", arguments->no_header, "where several agents share a terminal");
  set_help(
      *command,
      "Prints a line per frame, and writes a folder with the run's records ('robot_agent report' "
      "sums them up), what the arm was told (JSON lines) and overlays (PNG). SIGTERM and Ctrl-C "
      "end it after the pick in hand; SIGUSR1 or Enter goes on where it asks its operator.",
      {"robot_agent run --config deploy/cells/tees.yaml --recording build/piles --out build/tees",
       "robot_agent run --config deploy/cells/simulated_tees.yaml --pile 3 --out build/simulated"});
  command->callback([arguments] {
    if (const int code = run(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::robot_agent
