#include "commands.hpp"
#include "graspd/command_line/run_program.hpp"

int main(int count, char** words) {
  return graspd::run_program("grasp", count, words, [](CLI::App& app) {
    app.description("Asks grasp servers for grasps, and keeps their keys.");
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 planned (health: all ready; stats: all there; keys: done), 1 a defect of "
        "the "
        "server, 2 wrong command\nline, file or request, 3 try again (no server there, busy, out "
        "of "
        "time), 4 answered, but nothing to grasp, 5 (replay) answers differ from those before.\n\n"
        "Example: grasp plan --depth frame.png --camera camera.yaml --part tee --overlay plan.png");
    graspd::program::add_plan_command(app);
    graspd::program::add_health_command(app);
    graspd::program::add_stats_command(app);
    graspd::program::add_console_command(app);
    graspd::program::add_record_command(app);
    graspd::program::add_replay_command(app);
    graspd::program::add_keys_command(app);
  });
}
