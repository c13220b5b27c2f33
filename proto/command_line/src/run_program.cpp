#include "graspd/command_line/run_program.hpp"

#include <cstdio>
#include <stdexcept>

namespace graspd {

int run_program(const std::string& name, int count, char** words,
                const std::function<void(CLI::App&)>& describe) {
  try {
    CLI::App app("", name);
    describe(app);
    try {
      app.parse(count, words);
    } catch (const CLI::RuntimeError& error) {
      return error.get_exit_code();
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? kExitDone : kExitWrongInput;
    }
    return kExitDone;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s: INVALID_ARGUMENT: %s\n", name.c_str(), error.what());
    return kExitWrongInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return kExitFailed;
  }
}

}  // namespace graspd
