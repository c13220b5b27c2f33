#pragma once

#include <string>
#include <string_view>

#include "graspd/types/result.hpp"

namespace graspd::service {

/// `tcp://HOST:PORT`, taken apart. A port of `*` or 0 asks the system for a free one.
struct TcpEndpoint {
  std::string host;
  std::string port;

  /// Reachable from this machine alone.
  bool is_loopback() const;
};

/// \returns INVALID_ARGUMENT with an example of what would be right.
Result<TcpEndpoint> parse_endpoint(std::string_view text);

}  // namespace graspd::service
