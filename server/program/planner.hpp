#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "graspd/service/config.hpp"
#include "graspd/service/worker.hpp"

namespace graspd::program {

/// Perception with a server's parts and parameters bound: what `serve` and its workers share.
struct Planner {
  service::PlanHandler handler;
  ServerInfo server;
  std::vector<std::string> part_ids;
  std::shared_ptr<const service::GoldenFrame> golden;
};

/// Loads the parts. \returns INVALID_ARGUMENT naming each file that is wrong.
Result<Planner> make_planner(const service::ServerConfig& config);

/// Threads that each worker may use, where the configuration leaves it to the machine.
std::size_t threads_per_worker(const service::ServerConfig& config);

}  // namespace graspd::program
