#pragma once

#include "graspd/command_line/stop_signal.hpp"

namespace graspd::robot_agent {

/// From now on SIGINT and SIGTERM ask the agent to stop, and SIGUSR1 tells it to go on where it
/// waits for its operator.
void listen_for_signals();
/// Whether SIGUSR1 came since the last call.
bool told_to_go_on();

}  // namespace graspd::robot_agent
