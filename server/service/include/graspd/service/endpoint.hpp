#pragma once

#include <string>
#include <string_view>

#include "graspd/types/result.hpp"

namespace graspd::service {

/// `tcp://HOST:PORT` or `ipc://PATH`, taken apart. A port of `*` or 0 asks the system for a free
/// one.
struct Endpoint {
  std::string host;
  std::string port;
  std::string path;  ///< of ipc; empty for tcp

  /// Reachable from this machine alone.
  bool is_local() const;
};

/// \returns INVALID_ARGUMENT with an example of what would be right.
Result<Endpoint> parse_endpoint(std::string_view text);

}  // namespace graspd::service
