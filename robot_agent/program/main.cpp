#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "commands.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/progress.hpp"
#include "graspd/command_line/run_program.hpp"

namespace {

void set_up_log(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(
      "robot_agent",
      graspd::wants_colour(stderr) ? spdlog::color_mode::automatic : spdlog::color_mode::never));
  spdlog::set_pattern("%^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(level));
}

}  // namespace

int main(int count, char** words) {
  std::string log_level = "info";
  return graspd::run_program("robot_agent", count, words, [&](CLI::App& app) {
    app.description(
        "The agent of one robot cell: sends its depth frames to a grasp server and carries out the "
        "grasps that come back.");
    app.require_subcommand(1);
    graspd::set_help(
        app,
        "Exit codes: 0 done, 1 stopped or failed for the reason that the last line on stderr "
        "says, 2 wrong command line or file.",
        {"robot_agent simulate --part tee=12 --frames 1 --out build/tees_scene"});
    app.add_option("--log-level", log_level, "what is logged to stderr")
        ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
        ->type_name("LEVEL")
        ->capture_default_str();
    app.parse_complete_callback([&] { set_up_log(log_level); });
    graspd::robot_agent::add_calibrate_command(app);
    graspd::robot_agent::add_run_command(app);
    graspd::robot_agent::add_record_command(app);
    graspd::robot_agent::add_report_command(app);
    graspd::robot_agent::add_simulate_command(app);
  });
}
