#include "commands.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/run_program.hpp"

int main(int count, char** words) {
  return graspd::run_program("grasp", count, words, [](CLI::App& app) {
    app.description("Asks grasp servers for grasps, loads them, and keeps their keys.");
    app.require_subcommand(1);
    graspd::set_help(
        app,
        "Exit codes: 0 planned (health: all ready; stats: all there; keys: done), 1 a defect "
        "of the server, 2 wrong command line, file or request, 3 try again (no server there, "
        "busy, out of time), 4 answered, but nothing to grasp, 5 (replay) answers differ from "
        "those before.",
        {"grasp health"});
    graspd::program::add_plan_command(app);
    graspd::program::add_health_command(app);
    graspd::program::add_stats_command(app);
    graspd::program::add_console_command(app);
    graspd::program::add_record_command(app);
    graspd::program::add_replay_command(app);
    graspd::program::add_load_command(app);
    graspd::program::add_keys_command(app);
  });
}
