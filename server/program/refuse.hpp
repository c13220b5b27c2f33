#pragma once

#include <fmt/format.h>

#include "graspd/command_line/run_program.hpp"
#include "graspd/types/result.hpp"

namespace graspd::program {

/// Says on stderr what is wrong. \returns the exit code for that
inline int refuse(const Error& error) {
  fmt::print(stderr, "grasp_server: {}: {}\n", name_of(error.code), error.message);
  return kExitWrongInput;
}

}  // namespace graspd::program
