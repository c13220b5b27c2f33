#pragma once

/// What robot_agent's exit codes say; `robot_agent --help` documents them.
namespace graspd::robot_agent {

inline constexpr int kExitDone = 0;
inline constexpr int kExitStopped = 1;
inline constexpr int kExitWrongInput = 2;

}  // namespace graspd::robot_agent
