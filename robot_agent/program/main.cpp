#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "commands.hpp"
#include "exit_codes.hpp"

namespace {

using namespace graspd::robot_agent;

void set_up_log(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("robot_agent"));
  spdlog::set_pattern("%^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(level));
}

int run_program(int count, char** words) {
  CLI::App app(
      "The agent of one robot cell: sends its depth frames to a grasp server and carries out the "
      "grasps that come back.",
      "robot_agent");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 stopped or failed for the reason that the last line on stderr says, "
      "2 wrong command line or file.");
  std::string log_level = "info";
  app.add_option("--log-level", log_level, "what is logged to stderr")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->type_name("LEVEL")
      ->capture_default_str();
  app.parse_complete_callback([&] { set_up_log(log_level); });
  add_run_command(app);
  add_simulate_command(app);
  try {
    app.parse(count, words);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitWrongInput;
  }
  return kExitDone;
}

}  // namespace

int main(int count, char** words) {
  try {
    return run_program(count, words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error %s\n", error.what());
    return kExitStopped;
  }
}
