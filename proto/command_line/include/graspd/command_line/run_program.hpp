#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace graspd {

/// Exit codes that every program shares; each program's --help documents its own.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongInput = 2;

/// The whole of a program's main: `describe` adds options, subcommands and callbacks; parsing the
/// words runs what they name. Builds and tests ask with --print-man, --print-completions SHELL or
/// --print-examples, which print what `describe` said.
/// \returns what a callback threw as CLI::RuntimeError; kExitWrongInput for a wrong command line or
/// std::invalid_argument, kExitFailed for any other exception, each with its sentence on stderr.
int run_program(const std::string& name, int count, char** words,
                const std::function<void(CLI::App&)>& describe);

}  // namespace graspd
