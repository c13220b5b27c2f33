#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graspd/agent/ports.hpp"
#include "graspd/keys/key_files.hpp"

namespace graspd::agent {

/// Plans at the perception servers, through the client library.
/// \param endpoints their data endpoints, as "tcp://127.0.0.1:5555"; any of them will do.
/// \param budget for each plan, retries on other servers included.
/// \param keys where the servers want them: their public key, and that of `cell`.
/// \returns INVALID_ARGUMENT for no endpoint, one that is none, or another cell's key.
Result<std::unique_ptr<Planner>> connect_planner(const std::vector<std::string>& endpoints,
                                                 const std::string& cell,
                                                 std::chrono::milliseconds budget,
                                                 std::optional<keys::ClientKeys> keys = {});

}  // namespace graspd::agent
