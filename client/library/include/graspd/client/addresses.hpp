#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd::client {

/// Gives the addresses of a host's name, as in "10.0.0.7". May take its time: it is called on a
/// thread of its own.
using Resolve = std::function<Result<std::vector<std::string>>(const std::string& host)>;

/// As the system knows them (getaddrinfo): IPv4, like the sockets of libzmq.
Result<std::vector<std::string>> addresses_of(const std::string& host);

}  // namespace graspd::client
