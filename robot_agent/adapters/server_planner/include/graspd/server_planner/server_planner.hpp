#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "graspd/agent/ports.hpp"

namespace graspd::agent {

/// Plans at the perception servers, through the client library.
/// \param endpoints their data endpoints, as "tcp://127.0.0.1:5555"; any of them will do.
/// \param budget for each plan, retries on other servers included.
/// \returns INVALID_ARGUMENT for no endpoint, or one that is none.
Result<std::unique_ptr<Planner>> connect_planner(const std::vector<std::string>& endpoints,
                                                 const std::string& cell,
                                                 std::chrono::milliseconds budget);

}  // namespace graspd::agent
