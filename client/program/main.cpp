#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "commands.hpp"
#include "exit_codes.hpp"

int main(int count, char** words) {
  CLI::App app("Asks grasp servers for grasps.", "grasp");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 planned (health: all ready), 1 a defect of the server, 2 wrong command line, "
      "file or request,\n3 try again (no server there, busy, out of time), 4 answered, but nothing "
      "to grasp.\n\n"
      "Example: grasp plan --depth frame.png --camera camera.yaml --part tee --overlay plan.png");
  graspd::program::add_plan_command(app);
  graspd::program::add_health_command(app);
  try {
    app.parse(count, words);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : graspd::program::kExitWrongInput;
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "grasp: {}: {}\n", name_of(graspd::Code::kInvalidArgument), error.what());
    return graspd::program::kExitWrongInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "grasp: {}\n", error.what());
    return graspd::program::kExitServerDefect;
  }
  return 0;
}
