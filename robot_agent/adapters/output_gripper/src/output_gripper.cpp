#include "graspd/output_gripper/output_gripper.hpp"

#include <cmath>

#include "run_command.hpp"

namespace graspd::output_gripper {
namespace {

Command with_width(Command command, double width_m) {
  constexpr std::string_view kPlace = "{width_mm}";
  for (std::string& word : command) {
    if (const auto at = word.find(kPlace); at != std::string::npos) {
      word.replace(at, kPlace.size(), fmt::format("{:.1f}", width_m * 1e3));
    }
  }
  return command;
}

tl::unexpected<Error> not_confirmed(std::string_view what, const Command& command,
                                    const Finished& finished) {
  return fail(Code::kUnavailable, "the gripper did not confirm to {}: '{}' ended with {}{}{}", what,
              command[0], finished.exit_code, finished.last_line.empty() ? "" : ": ",
              finished.last_line);
}

class OutputGripper final : public agent::Gripper {
 public:
  OutputGripper(GripperOptions options, agent::Clock& clock)
      : options_(std::move(options)), clock_(clock) {}

  Result<void> open(double opening_width_m) override {
    if (!(opening_width_m >= 0 && opening_width_m <= options_.max_opening_m)) {
      return invalid("the gripper opens to 0 to {} m, not to {} m", options_.max_opening_m,
                     opening_width_m);
    }
    holds_ = false;
    return command("open", with_width(options_.open, opening_width_m));
  }

  Result<void> close() override {
    auto closed = command("close", options_.close);
    holds_ = closed.has_value();
    return closed;
  }

  Result<bool> holds_something() override {
    if (options_.sensor.empty()) return holds_;
    const auto finished = run_command(options_.sensor, options_.timeout);
    if (!finished) return not_ended("sense", finished.error());
    if (finished->exit_code > 1) return not_confirmed("sense", options_.sensor, *finished);
    // An object before a light barrier is not held by fingers that are open.
    return holds_ && finished->exit_code == 0;
  }

 private:
  Result<void> command(std::string_view what, const Command& words) {
    const auto finished = run_command(words, options_.timeout);
    if (!finished) return not_ended(what, finished.error());
    if (finished->exit_code != 0) return not_confirmed(what, words, *finished);
    clock_.sleep_for(options_.settle);
    return {};
  }

  static tl::unexpected<Error> not_ended(std::string_view what, const Error& error) {
    return fail(error.code, "the gripper did not confirm to {}: {}", what, error.message);
  }

  GripperOptions options_;
  agent::Clock& clock_;
  bool holds_ = false;  ///< as far as the commands tell
};

}  // namespace

Result<std::unique_ptr<agent::Gripper>> make_gripper(const GripperOptions& options,
                                                     agent::Clock& clock) {
  if (options.open.empty()) return invalid("the gripper has no command to open");
  if (options.close.empty()) return invalid("the gripper has no command to close");
  return std::make_unique<OutputGripper>(options, clock);
}

}  // namespace graspd::output_gripper
