#include "graspd/service/worker.hpp"

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <stdexcept>

#include "answer_size.hpp"
#include "graspd/codec/codec.hpp"
#include "messages.hpp"
#include "work_report.hpp"
#include "worker_loop.hpp"

namespace graspd::service {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::uint32_t kGoldenBudget_ms = 30'000;

std::int64_t ns_since(SteadyClock::time_point start) {
  return std::chrono::nanoseconds(SteadyClock::now() - start).count();
}

Answer refusal(const RequestId& id, Error error) {
  Answer answer;
  answer.id = id;
  answer.code = error.code;
  answer.message = std::move(error.message);
  return answer;
}

Result<PlanAnswer> call(const PlanHandler& handler, const DepthFrame& frame,
                        const PlanRequest& request, SteadyClock::time_point deadline) {
  try {
    return handler(frame, request, deadline);
  } catch (const std::bad_alloc&) {
    return fail(Code::kInternal,
                "planning needed more memory than a worker may have (worker_memory_limit_mib)");
  } catch (const std::exception& error) {
    return fail(Code::kInternal, "planning failed: {}", error.what());
  }
}

Answer compute(const WorkerOptions& options, const PlanHandler& handler, std::int64_t queue_ns,
               const zmq::message_t& envelope, const zmq::message_t& payload) {
  const auto start = SteadyClock::now();
  const Result<Request> request = codec::decode_request(bytes_of(envelope));
  if (!request) return refusal(codec::salvage_request_id(bytes_of(envelope)), request.error());
  const auto& plan_call = std::get<PlanCall>(request->call);
  const Result<DepthFrame> frame = codec::decode_frame(plan_call.frame, bytes_of(payload));
  if (!frame) return refusal(request->id, frame.error());
  const std::int64_t decode_ns = ns_since(start);

  const auto arrived = start - std::chrono::nanoseconds(queue_ns);
  const auto deadline = arrived + std::chrono::milliseconds(request->budget_ms);
  Result<PlanAnswer> plan = call(handler, *frame, plan_call.plan, deadline);
  if (!plan) return refusal(request->id, plan.error());
  plan->server = options.server;
  plan->timings.insert(plan->timings.begin(), {{"queue", queue_ns}, {"decode", decode_ns}});
  Answer answer;
  answer.id = request->id;
  answer.body = std::move(*plan);
  return answer;
}

/// The whole way of a request, but for the sockets.
Result<void> plan_golden_frame(const WorkerOptions& options, const PlanHandler& handler) {
  if (!options.golden) return {};
  const GoldenFrame& golden = *options.golden;
  const codec::EncodedFrame frame = codec::encode_frame(golden.frame, DepthEncoding::kRaw);
  Request request;
  request.cell = "golden frame";
  request.budget_ms = kGoldenBudget_ms;
  request.call = PlanCall{frame.description, golden.request};
  const Answer answer = compute(options, handler, 0, frame_of(codec::encode_request(request)),
                                zmq::message_t(frame.payload.data(), frame.payload.size()));
  const auto* plan = std::get_if<PlanAnswer>(&answer.body);
  if (plan == nullptr) return fail(answer.code, "the golden frame: {}", answer.message);
  if (auto ok = golden.check(*plan); !ok) {
    return fail(Code::kInternal, "the golden frame: {}", ok.error().message);
  }
  return {};
}

std::vector<zmq::message_t> introduction(const WorkerOptions& options, const PlanHandler& handler) {
  std::vector<zmq::message_t> frames;
  if (const auto fit = plan_golden_frame(options, handler); !fit) {
    frames.push_back(frame_of(verb::kUnfit));
    frames.push_back(frame_of(fit.error().message));
    return frames;
  }
  frames.push_back(frame_of(verb::kReady));
  frames.push_back(frame_of(options.server.catalogue_hash));
  frames.push_back(frame_of(options.server.config_hash));
  return frames;
}

void work(zmq::socket_t& socket, const WorkerOptions& options, const PlanHandler& handler) {
  (void)send(socket, introduction(options, handler));
  std::vector<zmq::pollitem_t> items{{socket.handle(), 0, ZMQ_POLLIN, 0}};
  Message message;
  while (true) {
    poll(items, kBeatInterval);
    if (!receive(socket, 5, message)) {
      std::vector<zmq::message_t> beat;
      beat.push_back(frame_of(verb::kBeat));
      (void)send(socket, std::move(beat));
      continue;
    }
    auto& frames = message.frames;
    if (frames[0].to_string_view() == verb::kStop) return;
    if (frames[0].to_string_view() != verb::kPlan || frames.size() != 5) {
      throw std::logic_error("worker: a message that is neither PLAN nor STOP");
    }
    const auto queue_ns = static_cast<std::int64_t>(number_of(frames[2]));
    Answer answer = compute(options, handler, queue_ns, frames[3], frames[4]);
    std::vector<zmq::message_t> done;
    done.push_back(frame_of(verb::kDone));
    done.push_back(std::move(frames[1]));
    std::string encoded = encode_within_limit(answer);
    done.push_back(frame_of(name_of(answer.code)));
    done.push_back(frame_of(encode(report_of(answer))));
    done.push_back(frame_of(encoded));
    (void)send(socket, std::move(done));
  }
}

}  // namespace

void run_worker(zmq::context_t& context, const WorkerOptions& options, const PlanHandler& handler) {
  try {
    zmq::socket_t socket(context, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::routing_id, options.identity);
    socket.set(zmq::sockopt::linger, 0);
    socket.connect(options.endpoint);
    work(socket, options, handler);
  } catch (const zmq::error_t& error) {
    if (error.num() != ETERM) throw;
  }
}

void run_worker(const WorkerOptions& options, const PlanHandler& handler) {
  zmq::context_t context;
  run_worker(context, options, handler);
}

void prepare_worker_process(std::uint32_t memory_limit_mib) {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // Data, not address space: half a gigabyte of libraries is mapped, but not used. A sanitizer's
  // shadow memory is terabytes of data to the kernel, hence no limit there.
  if (memory_limit_mib > 0) {
    const rlim_t limit_bytes = static_cast<rlim_t>(memory_limit_mib) << 20;
    const rlimit limit{limit_bytes, limit_bytes};
    if (setrlimit(RLIMIT_DATA, &limit) != 0) {
      throw std::runtime_error("cannot limit the worker's memory: setrlimit failed");
    }
  }
#else
  (void)memory_limit_mib;
#endif
}

}  // namespace graspd::service
