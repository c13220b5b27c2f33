#include "commands.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/command_line/run_program.hpp"
#include "graspd/eval/command.hpp"
#include "graspd/service/build_id.hpp"

int main(int count, char** words) {
  return graspd::run_program("grasp_server", count, words, [](CLI::App& app) {
    app.description("graspd: plans grasps for bins of piled parts from depth frames.");
    app.require_subcommand(1);
    app.set_version_flag("--version", "grasp_server " + graspd::service::build_id());
    graspd::set_help(
        app,
        "Exit codes: 0 done (serve: stopped when told to), 1 failed or errors found, 2 wrong "
        "command line or file, 3 cannot listen (endpoint in use).",
        {"grasp_server serve --config deploy/server.yaml --insecure"});
    graspd::program::add_serve_command(app);
    graspd::program::add_part_command(app);
    graspd::eval::add_eval_command(app);
    graspd::program::add_worker_command(app);
  });
}
