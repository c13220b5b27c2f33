#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::output_gripper {

struct Finished {
  int exit_code = 0;
  std::string last_line;  ///< on stderr
};

/// Runs a program to its end. It and its children are killed when the time is over.
/// \returns UNAVAILABLE where it can't be run, is ended by a signal, or is out of time.
Result<Finished> run_command(const std::vector<std::string>& words,
                             std::chrono::milliseconds timeout);

}  // namespace graspd::output_gripper
