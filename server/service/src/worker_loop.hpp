#pragma once

#include <zmq.hpp>

#include "graspd/service/worker.hpp"

namespace graspd::service {

/// `run_worker` on a context of the caller's. Shutting the context down ends it too.
void run_worker(zmq::context_t& context, const WorkerOptions& options, const PlanHandler& handler);

}  // namespace graspd::service
