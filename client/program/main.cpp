#include <cstdio>
#include <exception>
#include <stdexcept>

#include "commands.hpp"
#include "exit_codes.hpp"

namespace graspd::program {
namespace {

int run(int count, char** words) {
  CLI::App app("Asks grasp servers for grasps.", "grasp");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 planned (health: all ready), 1 a defect of the server, 2 wrong command line, "
      "file or request,\n3 try again (no server there, busy, out of time), 4 answered, but nothing "
      "to grasp.\n\n"
      "Example: grasp plan --depth frame.png --camera camera.yaml --part tee --overlay plan.png");
  add_plan_command(app);
  add_health_command(app);
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
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "grasp: INVALID_ARGUMENT: %s\n", error.what());
    return graspd::program::kExitWrongInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "grasp: %s\n", error.what());
    return graspd::program::kExitServerDefect;
  }
}
