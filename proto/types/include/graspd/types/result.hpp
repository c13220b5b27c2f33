#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "graspd/types/enum_names.hpp"

namespace graspd {

/// Why a request got no plan. The same list on the wire, on the command line and in logs;
/// proto/PROTOCOL.md says what a caller does about each.
enum class Code {
  kOk,
  kInvalidArgument,     ///< The request or a file is wrong: mend it, do not retry.
  kUnsupportedVersion,  ///< Client and server speak different protocol versions.
  kUnauthenticated,     ///< The key is unknown, or belongs to another cell.
  kUnknownPart,         ///< The server's catalogue has no such part.
  kBusy,                ///< Shed: retry after `retry_after_ms`, or on another server.
  kSuperseded,          ///< A newer frame of the same cell took this one's place.
  kDeadlineExceeded,    ///< The time budget ended before an answer.
  kDraining,            ///< The server is shutting down: use another.
  kRejectedPoison,      ///< This very frame has crashed workers: do not send it again.
  kInternal,            ///< A defect in the server: report it with the request id.
  kUnavailable,         ///< No server answered. Made by the client, never on the wire.
};

template <>
struct EnumNames<Code> {
  static constexpr std::string_view what = "code";
  static constexpr std::pair<Code, std::string_view> values[] = {
      {Code::kOk, "OK"},
      {Code::kInvalidArgument, "INVALID_ARGUMENT"},
      {Code::kUnsupportedVersion, "UNSUPPORTED_VERSION"},
      {Code::kUnauthenticated, "UNAUTHENTICATED"},
      {Code::kUnknownPart, "UNKNOWN_PART"},
      {Code::kBusy, "BUSY"},
      {Code::kSuperseded, "SUPERSEDED"},
      {Code::kDeadlineExceeded, "DEADLINE_EXCEEDED"},
      {Code::kDraining, "DRAINING"},
      {Code::kRejectedPoison, "REJECTED_POISON"},
      {Code::kInternal, "INTERNAL"},
      {Code::kUnavailable, "UNAVAILABLE"},
  };
};

/// An expected failure: a code, and a sentence that says what is wrong, where, and what to do.
struct Error {
  Code code = Code::kInternal;
  std::string message;
};

/// What is wanted, or why there is none.
template <class T>
using Result = tl::expected<T, Error>;

/// `return fail(Code::kInvalidArgument, "part '{}': …", id);`
template <class... Args>
tl::unexpected<Error> fail(Code code, fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected<Error>(Error{code, fmt::format(format, std::forward<Args>(args)...)});
}

/// `fail` with INVALID_ARGUMENT.
template <class... Args>
tl::unexpected<Error> invalid(fmt::format_string<Args...> format, Args&&... args) {
  return fail(Code::kInvalidArgument, format, std::forward<Args>(args)...);
}

}  // namespace graspd
