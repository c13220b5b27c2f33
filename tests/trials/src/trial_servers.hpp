#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graspd/trials/load.hpp"
#include "graspd/trials/trials.hpp"
#include "serve_process.hpp"

/// What all trials begin and end with.
namespace graspd::trials {

/// The one place where the trials' servers get their configuration.
std::unique_ptr<testing::ServeProcess> start_server(int workers_n,
                                                    const std::string& endpoint = {});
LoadOptions cells_of(const std::vector<std::string>& endpoints, int cells_n);
/// \throws std::runtime_error where the server does not answer.
HealthAnswer health_of(const std::string& endpoint);
Seen seen_in(const History& history);

}  // namespace graspd::trials
