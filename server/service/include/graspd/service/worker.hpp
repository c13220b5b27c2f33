#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "graspd/types/answer.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::service {

/// What a worker does with a request: perception's `plan` with its catalogue and parameters bound,
/// or a test's script. After the deadline nobody waits for the answer any more.
using PlanHandler = std::function<Result<PlanAnswer>(
    const DepthFrame&, const PlanRequest&, std::chrono::steady_clock::time_point deadline)>;

/// A request whose answer is known beforehand.
struct GoldenFrame {
  DepthFrame frame;
  PlanRequest request;
  /// \returns a sentence about an answer that is not as it must be.
  std::function<Result<void>(const PlanAnswer&)> check;
};

/// What a worker must know of its front.
struct WorkerOptions {
  std::string endpoint;                       ///< the front's
  std::string identity;                       ///< the name that the front gave this worker
  ServerInfo server;                          ///< goes into every answer
  std::shared_ptr<const GoldenFrame> golden;  ///< none: READY without a test
};

/// Plans the golden frame, decoded as any other request is. Where the answer is not as it must be,
/// says UNFIT and why, and never gets work. Else says READY, works off what the front sends, one
/// request at a time, and says BEAT while there is nothing to do. Heartbeats come from the thread
/// that works, so that they vouch for it. Returns when the front says STOP. A handler's exception
/// becomes an INTERNAL answer.
void run_worker(const WorkerOptions& options, const PlanHandler& handler);

/// For a process that is a worker and nothing else: limits its memory (0: no limit), and leaves the
/// signals that end or reload a server to the front. Call before any other thread starts.
void prepare_worker_process(std::uint32_t memory_limit_mib);

}  // namespace graspd::service
