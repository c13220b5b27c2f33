#include <signal.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "cell_config.hpp"
#include "cell_frames.hpp"
#include "commands.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/record/recording_arm.hpp"
#include "graspd/server_planner/server_planner.hpp"
#include "report.hpp"
#include "system_clock.hpp"

namespace graspd::robot_agent {
namespace {

/// What the command line may say over the configuration.
struct RunArguments {
  std::filesystem::path config;
  std::filesystem::path output = ".";
  std::vector<std::string> servers;
  std::filesystem::path recording;
  std::optional<std::uint32_t> frames_n;
  bool no_header = false;
};

volatile sig_atomic_t asked_to_stop = 0;

void listen_for_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { asked_to_stop = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

Result<CellConfig> configure(const RunArguments& arguments) {
  auto config = read_cell_config(arguments.config, arguments.output);
  if (!config) return config;
  if (!arguments.servers.empty()) config->servers = arguments.servers;
  if (!arguments.recording.empty()) config->camera.path = arguments.recording;
  if (arguments.frames_n) config->camera.frames_n = *arguments.frames_n;
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
  agent::Task task;
  task.request.T_base_camera = frames.T_base_camera;
  task.request.bin = frames.bin;
  task.request.parts = config.parts;
  task.request.gripper = config.gripper;
  task.request.options = config.options;
  task.request.options.outlines = !config.overlays.empty();
  task.T_base_place = config.T_base_place;
  task.failed_spot_radius_m = config.failed_spot_radius_m;
  task.retry = config.retry;
  if (const auto ok = validate(task.request); !ok) return tl::unexpected(ok.error());
  return task;
}

Result<std::unique_ptr<agent::Camera>> make_camera(const CameraConfig& config,
                                                   const CellFrames& frames, agent::Clock& clock) {
  replay::ReplayOptions options;
  options.loop = config.loop;
  if (config.frames_n > 0) options.max_frames_n = config.frames_n;
  options.period = std::chrono::nanoseconds(static_cast<std::int64_t>(config.period_s * 1e9));
  options.intrinsics = frames.intrinsics;
  return replay::open_recording(config.kind, config.path, options, clock);
}

/// \returns whether the cycle is done, rather than stopped.
bool pick(const std::string& cell, agent::PickCycle& cycle) {
  while (!cycle.is_over()) {
    if (asked_to_stop) cycle.finish();
    const agent::State before = cycle.state();
    const agent::State after = cycle.step();
    spdlog::debug("{}: {} -> {}", cell, name_of(before), name_of(after));
  }
  return cycle.state() == agent::State::kDone;
}

Result<int> run_cell(const RunArguments& arguments) {
  const auto config = configure(arguments);
  if (!config) return tl::unexpected(config.error());
  const auto frames = find_cell_frames(*config);
  if (!frames) return tl::unexpected(frames.error());
  const auto task = make_task(*config, *frames);
  if (!task) return tl::unexpected(task.error());

  SystemClock clock;
  const auto camera = make_camera(config->camera, *frames, clock);
  if (!camera) return tl::unexpected(camera.error());
  const auto planner = make_planner(*config);
  if (!planner) return tl::unexpected(planner.error());
  auto arm = record::RecordingArm::create(config->arm_record,
                                          {config->cell, frames->T_base_camera, frames->bin});
  if (!arm) return tl::unexpected(arm.error());
  auto picks = record::JsonLines::create(config->pick_records);
  if (!picks) return tl::unexpected(picks.error());

  Reporter reporter(config->cell, *std::move(picks), config->overlays);
  agent::PickCycle cycle({**camera, **planner, *arm, *arm, clock}, *task, reporter);
  spdlog::info("{}: planning at {}, replaying {}", config->cell, fmt::join(config->servers, ", "),
               config->camera.path.lexically_normal().string());
  if (!arguments.no_header) fmt::print("{}\n", report_header());
  std::fflush(stdout);  // above the lines of other agents that share the terminal
  const bool done = pick(config->cell, cycle);
  spdlog::log(done ? spdlog::level::info : spdlog::level::err, "{}: {}, {} parts placed: {}",
              config->cell, done ? "done" : "stopped", reporter.placed_n(), cycle.reason());
  return done ? kExitDone : kExitFailed;
}

int run(const RunArguments& arguments) {
  listen_for_signals();
  const auto exit_code = run_cell(arguments);
  if (exit_code) return *exit_code;
  spdlog::error("{}", exit_code.error().message);
  return kExitWrongInput;
}

}  // namespace

void add_run_command(CLI::App& app) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* command =
      app.add_subcommand("run", "pick in a cell until its bin is empty or its recording is over");
  command
      ->add_option("--config", arguments->config,
                   "what the cell is and does; deploy/cells/tees.yaml explains it")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", arguments->output, "folder for what is written; default: this one")
      ->type_name("DIR");
  command->add_option("--server", arguments->servers, "ask these, not the configuration's")
      ->type_name("tcp://HOST:PORT");
  command->add_option("--recording", arguments->recording, "replay this, not the configuration's")
      ->type_name("PATH");
  command->add_option("--frames", arguments->frames_n, "end after so many frames")->type_name("N");
  command->add_flag("--no-header", arguments->no_header, "where several agents share a terminal");
  command->footer(
      "Prints a line per frame, and writes picks (JSON lines), what the arm was told (JSON lines) "
      "and overlays (PNG).\nSIGTERM and Ctrl-C end it after the pick in hand.\n\n"
      "Example: robot_agent run --config deploy/cells/tees.yaml --out build/tees");
  command->callback([arguments] {
    if (const int code = run(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::robot_agent
