#include <spdlog/spdlog.h>

#include <cstdio>

#include "cell_request.hpp"
#include "commands.hpp"
#include "equipment.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "signals.hpp"

namespace graspd::robot_agent {
namespace {

struct RecordArguments {
  std::filesystem::path config;
  std::filesystem::path output;
  std::optional<std::uint64_t> frames_n;
};

/// A frame's stamp is monotonic time of the cell, a recording's is the wall's.
double wall_stamp_s(const DepthFrame& frame, agent::Clock& clock) {
  const auto now_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch());
  const auto age = frame.stamp ? clock.now() - *frame.stamp : std::chrono::nanoseconds(0);
  return (now_s - age).count();
}

/// Until the camera has no more, N frames are there, or somebody asks to stop.
/// \returns how many there are.
Result<std::uint64_t> record_frames(const RecordArguments& arguments, const PlanRequest& request,
                                    const Equipment& equipment, RawlogWriter& rawlog) {
  const std::string request_json = codec::to_json(request, false);
  std::uint64_t frames_n = 0;
  Progress progress("frames", arguments.frames_n.value_or(0));
  while (!asked_to_stop() && (!arguments.frames_n || frames_n < *arguments.frames_n)) {
    auto frame = equipment.camera->next();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) break;
    const double stamp_s = wall_stamp_s(**frame, *equipment.clock);
    const auto added =
        rawlog.add({std::move(**frame), stamp_s, request.T_base_camera, request_json});
    if (!added) return tl::unexpected(added.error());
    ++frames_n;
    progress.step();
  }
  return frames_n;
}

Result<void> record(const RecordArguments& arguments) {
  // What a run of the cell writes beside it, a recording does not.
  const auto config = read_cell_config(arguments.config, arguments.output.parent_path());
  if (!config) return tl::unexpected(config.error());
  const auto frames = find_cell_frames(*config);
  if (!frames) return tl::unexpected(frames.error());
  const auto request = make_request(*config, *frames);
  if (!request) return tl::unexpected(request.error());
  const auto equipment = make_camera(*config, *frames);
  if (!equipment) return tl::unexpected(equipment.error());
  auto rawlog = RawlogWriter::create(arguments.output);
  if (!rawlog) return tl::unexpected(rawlog.error());

  spdlog::info("{}: recording to {}", config->cell, arguments.output.string());
  const auto recorded = record_frames(arguments, *request, *equipment, *rawlog);
  // What is there stays, whatever ended it.
  const auto finished = rawlog->finish();
  if (!recorded) return tl::unexpected(recorded.error());
  if (!finished) return tl::unexpected(finished.error());
  fmt::print("{}: {} frame{}, {:.1f} MB\n", arguments.output.string(), *recorded,
             *recorded == 1 ? "" : "s",
             static_cast<double>(std::filesystem::file_size(arguments.output)) / 1e6);
  return {};
}

int run(const RecordArguments& arguments) {
  listen_for_signals();
  const auto recorded = record(arguments);
  if (recorded) return kExitDone;
  const Error& error = recorded.error();
  spdlog::error("{}", error.message);
  return error.code == Code::kInvalidArgument ? kExitWrongInput : kExitFailed;
}

}  // namespace

void add_record_command(CLI::App& app) {
  const auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command =
      app.add_subcommand("record", "write what a cell's camera sees as an MRPT rawlog");
  command->add_option("--config", arguments->config, "of the cell, as for `robot_agent run`")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", arguments->output, "the rawlog")->required()->type_name("FILE");
  command->add_option("--frames", arguments->frames_n, "end after so many frames")->type_name("N");
  set_help(*command,
           "In front of the frames stands what the cell would ask a server: parts, bin, camera "
           "pose, gripper. Neither arm nor server is asked for anything. SIGTERM and Ctrl-C end "
           "it; what was recorded can be read, whatever ended it. 'grasp replay' asks a server "
           "with it, 'robot_agent run --recording' picks from it, RawLogViewer shows it.",
           {"robot_agent record --config deploy/cells/tees.yaml --out build/tees.rawlog"});
  command->callback([arguments] {
    if (const int code = run(*arguments)) throw CLI::RuntimeError(code);
  });
}

}  // namespace graspd::robot_agent
