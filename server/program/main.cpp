#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/eval/command.hpp"
#include "graspd/service/build_id.hpp"

int main(int count, char** words) {
  CLI::App app("graspd: plans grasps for bins of piled parts from depth frames.", "grasp_server");
  app.set_version_flag("--version", "grasp_server " + graspd::service::build_id());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done (serve: stopped when told to), 1 failed or errors found, 2 wrong command "
      "line or file,\n3 cannot listen (endpoint in use).");
  graspd::program::add_serve_command(app);
  graspd::program::add_part_command(app);
  graspd::eval::add_eval_command(app);
  graspd::program::add_worker_command(app);
  try {
    app.parse(count, words);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : graspd::program::kExitWrongInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "grasp_server: {}\n", error.what());
    return graspd::program::kExitFailed;
  }
  return 0;
}
