#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "graspd/agent/ports.hpp"

/// A gripper on an output line: whatever sets the line (a GPIO tool, a PLC's client) is a command.
namespace graspd::output_gripper {

/// A program and its arguments; no shell is between. Exit code 0 confirms.
using Command = std::vector<std::string>;

/// The gripper's commands and times.
struct GripperOptions {
  /// "{width_mm}" in an argument becomes the opening width, for a gripper that can be opened to
  /// one.
  Command open;
  Command close;
  /// Exit code 0: something is between the fingers, 1: nothing is. Without it a close that was
  /// confirmed counts as held, so that only the camera sees a missed pick.
  Command sensor;
  std::chrono::milliseconds timeout{2000};  ///< of each command; then it is killed
  std::chrono::milliseconds settle{300};    ///< the fingers' way, after open and close
  double max_opening_m = 0.08;
};

/// A command that can't be run, fails or does not end in time is UNAVAILABLE, with its last line on
/// stderr: the gripper did not confirm, and the cycle stops with the part where it is.
///
/// \returns INVALID_ARGUMENT where open or close has no command.
Result<std::unique_ptr<agent::Gripper>> make_gripper(const GripperOptions& options,
                                                     agent::Clock& clock);

}  // namespace graspd::output_gripper
