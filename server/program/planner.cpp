#include "planner.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "golden_frame.hpp"
#include "graspd/parts/catalogue.hpp"
#include "graspd/perception/planner.hpp"
#include "graspd/service/build_id.hpp"

namespace graspd::program {

Result<Planner> make_planner(const service::ServerConfig& config) {
  auto loaded = parts::Catalogue::load(config.parts);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto catalogue = std::make_shared<const parts::Catalogue>(*std::move(loaded));

  Planner planner;
  for (const parts::Part& part : catalogue->parts()) planner.part_ids.push_back(part.id);
  planner.server = {service::build_id(), catalogue->hash(),
                    service::config_hash(config.perception)};
  planner.golden = std::make_shared<const service::GoldenFrame>(
      make_golden_frame(catalogue->parts().front(), config.perception));
  planner.handler = [catalogue, parameters = config.perception](
                        const DepthFrame& frame, const PlanRequest& request,
                        std::chrono::steady_clock::time_point deadline) {
    return perception::plan(frame, request, *catalogue, parameters,
                            [&] { return std::chrono::steady_clock::now() >= deadline; });
  };
  return planner;
}

std::size_t threads_per_worker(const service::ServerConfig& config) {
  if (config.worker_threads_n > 0) return config.worker_threads_n;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  return std::max(1U, cores / std::max(1U, config.workers_n));
}

}  // namespace graspd::program
