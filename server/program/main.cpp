#include <cstdio>
#include <exception>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/eval/command.hpp"
#include "graspd/service/build_id.hpp"

namespace graspd::program {
namespace {

int run(int count, char** words) {
  CLI::App app("graspd: plans grasps for bins of piled parts from depth frames.", "grasp_server");
  app.set_version_flag("--version", "grasp_server " + service::build_id());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done (serve: stopped when told to), 1 failed or errors found, 2 wrong command "
      "line or file,\n3 cannot listen (endpoint in use).");
  add_serve_command(app);
  add_part_command(app);
  eval::add_eval_command(app);
  add_worker_command(app);
  try {
    app.parse(count, words);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitWrongInput;
  }
  return 0;
}

}  // namespace
}  // namespace graspd::program

int main(int count, char** words) {
  try {
    return graspd::program::run(count, words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "grasp_server: %s\n", error.what());
    return graspd::program::kExitFailed;
  }
}
