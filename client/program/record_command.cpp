#include <fmt/format.h>

#include <memory>
#include <thread>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/codec/codec.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/stop_signal.hpp"
#include "graspd/recorded/questions.hpp"
#include "graspd/recordings/rawlog.hpp"

namespace graspd::program {
namespace {

using recorded::Question;

constexpr std::chrono::milliseconds kFollowInterval{200};

struct RecordArguments {
  std::string flights;
  std::string out;
  std::string cell;
  bool follow = false;
};

/// A flight record as one frame of a rawlog.
Result<RecordedFrame> recorded_frame(const FlightRecord& flight) {
  const auto envelope = std::as_bytes(std::span(flight.request));
  const auto request = codec::decode_request(envelope);
  if (!request) return tl::unexpected(request.error());
  auto json = codec::plan_request_json(envelope);
  if (!json) return tl::unexpected(json.error());
  const auto& call = std::get<PlanCall>(request->call);
  auto frame = codec::decode_frame(call.frame, std::as_bytes(std::span(flight.depth_image)));
  if (!frame) return tl::unexpected(frame.error());
  RecordedFrame recorded{*std::move(frame), flight.stamp_s, call.plan.T_base_camera,
                         *std::move(json)};
  // Where there is no plan in the answer, there is nothing to compare with.
  recorded.answer = codec::plan_answer_json(std::as_bytes(std::span(flight.answer))).value_or("");
  return recorded;
}

/// Flights of one cell, into one rawlog.
class CellRecording {
 public:
  CellRecording(RawlogWriter rawlog, std::string cell)
      : rawlog_(std::move(rawlog)), cell_(std::move(cell)) {}

  Result<void> add(const Question& question) {
    const FlightRecord& flight = question.asked;
    last_ = question.name;
    if (cell_.empty()) cell_ = flight.cell;
    if (flight.cell != cell_) {
      ++others_n_;
      other_cell_ = flight.cell;
      return {};
    }
    const auto recorded = recorded_frame(flight);
    if (!recorded) {
      progress_.hide();
      fmt::print(stderr, "grasp: {}: left out: {}\n", question.name, recorded.error().message);
      return {};
    }
    if (auto ok = rawlog_.add(*recorded); !ok) return ok;
    ++frames_n_;
    progress_.step();
    return {};
  }
  Result<void> finish() {
    progress_.hide();
    return rawlog_.finish();
  }

  /// Of the last flight that was looked at.
  const std::string& last() const { return last_; }
  std::string summary() const {
    std::string text =
        fmt::format("{} frame{} of cell '{}'", frames_n_, frames_n_ == 1 ? "" : "s", cell_);
    if (others_n_ > 0) {
      text += fmt::format("; {} of other cells left out, as '{}': --cell says which is recorded",
                          others_n_, other_cell_);
    }
    return text;
  }

 private:
  RawlogWriter rawlog_;
  std::string cell_;
  std::string last_;
  std::string other_cell_;
  std::size_t frames_n_ = 0;
  std::size_t others_n_ = 0;
  Progress progress_{"frames"};
};

Result<void> add_all(const RecordArguments& arguments, CellRecording& recording) {
  auto flights = recorded::open_flights_after(arguments.flights, recording.last());
  if (!flights) return tl::unexpected(flights.error());
  while (!asked_to_stop()) {
    auto question = (*flights)->next();
    if (!question) return tl::unexpected(question.error());
    if (!*question) return {};
    if (auto ok = recording.add(**question); !ok) return ok;
  }
  return {};
}

Result<int> record(const RecordArguments& arguments) {
  if (!arguments.follow) {
    if (auto any = recorded::open_questions(arguments.flights); !any) {
      return tl::unexpected(any.error());
    }
  }
  auto rawlog = RawlogWriter::create(arguments.out);
  if (!rawlog) return tl::unexpected(rawlog.error());
  CellRecording recording(*std::move(rawlog), arguments.cell);
  listen_for_stop();
  auto added = add_all(arguments, recording);
  while (added && arguments.follow && !asked_to_stop()) {
    std::this_thread::sleep_for(kFollowInterval);
    added = add_all(arguments, recording);
  }
  const auto finished = recording.finish();
  fmt::print("{}: {}\n", arguments.out, recording.summary());
  if (!added) return tl::unexpected(added.error());
  if (!finished) return tl::unexpected(finished.error());
  return 0;
}

}  // namespace

void add_record_command(CLI::App& app) {
  const auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command = app.add_subcommand(
      "record", "make a rawlog of what a server's flight recorder keeps of a cell");
  command->add_option("flights", arguments->flights, "the recorder's folder, or the cell's in it")
      ->type_name("DIR")
      ->required();
  command->add_option("--out", arguments->out, "the rawlog")->type_name("FILE")->required();
  command->add_option("--cell", arguments->cell, "of which cell; default: the first one found")
      ->type_name("NAME");
  command->add_flag("--follow", arguments->follow, "go on with what comes, until Ctrl-C");
  set_help(
      *command,
      "A server keeps every request of its cells where its configuration says flight_recorder: "
      "keep: all. In front of each frame stand the request (part, bin, camera pose, gripper) and "
      "its answer. 'robot_agent record' records from a cell's camera, without a server.",
      {"grasp record build/flights --cell tees --out build/flights.rawlog"});
  command->callback([arguments] { finish(record(*arguments)); });
}

}  // namespace graspd::program
