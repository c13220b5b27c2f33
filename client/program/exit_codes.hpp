#pragma once

#include <fmt/format.h>

#include <cstdio>

#include "graspd/command_line/run_program.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/result.hpp"

/// What grasp's exit codes say; `grasp --help` documents them.
namespace graspd::program {

inline constexpr int kExitTryAgain = 3;
inline constexpr int kExitNothingToGrasp = 4;
inline constexpr int kExitDiffers = 5;

inline int exit_code(Code code) {
  switch (code) {
    case Code::kOk:
      return 0;
    case Code::kInvalidArgument:
    case Code::kUnsupportedVersion:
    case Code::kUnauthenticated:
    case Code::kUnknownPart:
      return kExitWrongInput;
    case Code::kBusy:
    case Code::kSuperseded:
    case Code::kDeadlineExceeded:
    case Code::kDraining:
    case Code::kUnavailable:
      return kExitTryAgain;
    case Code::kRejectedPoison:
    case Code::kInternal:
      break;
  }
  return kExitFailed;
}

inline int exit_code(Outcome outcome) {
  return outcome == Outcome::kPlanned || outcome == Outcome::kUnchanged ? 0 : kExitNothingToGrasp;
}

inline void print_error(const Error& error) {
  fmt::print(stderr, "grasp: {}: {}\n", name_of(error.code), error.message);
}

/// Ends a command: with the exit code it came to, or with what went wrong on stderr.
inline void finish(const Result<int>& code) {
  if (!code) {
    print_error(code.error());
    throw CLI::RuntimeError(exit_code(code.error().code));
  }
  if (*code != 0) throw CLI::RuntimeError(*code);
}

}  // namespace graspd::program
