#pragma once

/// What grasp_server's exit codes say; `grasp_server --help` documents them.
namespace graspd::program {

inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongInput = 2;
inline constexpr int kExitCannotListen = 3;

}  // namespace graspd::program
