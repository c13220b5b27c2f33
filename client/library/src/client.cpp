#include "graspd/client/client.hpp"

#include <sys/random.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "graspd/codec/codec.hpp"
#include "loop.hpp"

namespace graspd::client {
namespace {

/// The part of an answer that was asked for.
template <class T>
Result<T> body_of(Result<Answer> answer) {
  if (!answer) return tl::unexpected(std::move(answer.error()));
  if (auto* body = std::get_if<T>(&answer->body)) return std::move(*body);
  return fail(Code::kInternal, "the server answered another question than was asked");
}

}  // namespace

void print_warning(const std::string& message) { fmt::print(stderr, "warning: {}\n", message); }

RequestId new_request_id() {
  RequestId id;
  if (getrandom(id.data(), id.size(), 0) != static_cast<ssize_t>(id.size())) {
    throw std::system_error(errno, std::generic_category(), "getrandom");
  }
  return id;
}

Result<PreparedPlan> prepare(const DepthFrame& frame, const PlanRequest& request,
                             DepthEncoding encoding) {
  if (auto ok = validate(frame); !ok) return tl::unexpected(ok.error());
  if (auto ok = validate(request); !ok) return tl::unexpected(ok.error());
  codec::EncodedFrame encoded = codec::encode_frame(frame, encoding);
  return PreparedPlan{{encoded.description, request},
                      std::make_shared<const std::vector<std::byte>>(std::move(encoded.payload))};
}

Client::Client(const std::vector<std::string>& endpoints, ClientOptions options)
    : options_(std::move(options)),
      loop_(std::make_unique<Loop>(endpoints, options_.keys, options_.dispatch, options_.names)) {}

Client::~Client() = default;

Result<PlanAnswer> Client::plan(const DepthFrame& frame, const PlanRequest& request,
                                std::chrono::milliseconds budget, const RequestId& id) {
  return submit(frame, request, budget, id).get();
}

std::future<Result<PlanAnswer>> Client::submit(const DepthFrame& frame, const PlanRequest& request,
                                               std::chrono::milliseconds budget,
                                               const RequestId& id) {
  auto promise = std::make_shared<std::promise<Result<PlanAnswer>>>();
  if (const auto plan = prepare(frame, request, options_.encoding)) {
    submit(*plan, budget, id,
           [promise](PlanEnd end) { promise->set_value(std::move(end.answer)); });
  } else {
    promise->set_value(tl::unexpected(plan.error()));
  }
  return promise->get_future();
}

void Client::submit(const PreparedPlan& plan, std::chrono::milliseconds budget, const RequestId& id,
                    std::function<void(PlanEnd)> done) {
  Loop::Call call;
  call.request.id = id;
  call.request.cell = options_.cell;
  call.request.call = plan.call;
  call.payload = plan.payload;
  call.deadline = Clock::now() + budget;
  call.done = [done = std::move(done)](Result<Answer> answer, std::optional<TimePoint> sent) {
    const TimePoint ended = Clock::now();
    done({body_of<PlanAnswer>(std::move(answer)), sent, ended});
  };
  loop_->post(std::move(call));
}

Result<PlanAnswer> Client::ask_again(std::string_view envelope, std::string_view depth_image,
                                     std::chrono::milliseconds budget, const RequestId& id) {
  auto request = codec::decode_request(std::as_bytes(std::span(envelope)));
  if (!request) return tl::unexpected(request.error());
  const auto* plan = std::get_if<PlanCall>(&request->call);
  if (plan == nullptr) return invalid("this is no plan request");
  const auto image = std::as_bytes(std::span(depth_image));
  if (auto frame = codec::decode_frame(plan->frame, image); !frame) {
    return tl::unexpected(frame.error());
  }
  Loop::Call call;
  call.request = *std::move(request);
  call.request.id = id;
  if (options_.keys || call.request.cell.empty()) call.request.cell = options_.cell;
  call.envelope = envelope;
  call.payload = std::make_shared<const std::vector<std::byte>>(image.begin(), image.end());
  call.deadline = Clock::now() + budget;
  auto promise = std::make_shared<std::promise<Result<PlanAnswer>>>();
  call.done = [promise](Result<Answer> answer, std::optional<TimePoint>) {
    promise->set_value(body_of<PlanAnswer>(std::move(answer)));
  };
  loop_->post(std::move(call));
  return promise->get_future().get();
}

std::vector<ServerHealth> Client::health(std::chrono::milliseconds budget) {
  const TimePoint deadline = Clock::now() + budget;
  const Directory servers = loop_->servers(deadline);
  std::vector<std::future<Result<HealthAnswer>>> futures;
  for (const std::string& endpoint : servers.endpoints) {
    Loop::Call call;
    call.request.id = new_request_id();
    call.request.cell = options_.cell;
    call.request.call = HealthCall{};
    call.deadline = deadline;
    call.only = endpoint;
    auto promise = std::make_shared<std::promise<Result<HealthAnswer>>>();
    call.done = [promise](Result<Answer> answer, std::optional<TimePoint>) {
      promise->set_value(body_of<HealthAnswer>(std::move(answer)));
    };
    futures.push_back(promise->get_future());
    loop_->post(std::move(call));
  }
  std::vector<ServerHealth> healths;
  for (std::size_t server = 0; server < futures.size(); ++server) {
    healths.push_back({servers.endpoints[server], futures[server].get()});
  }
  for (const auto& [endpoint, error] : servers.unresolved) {
    healths.push_back({endpoint, tl::unexpected(error)});
  }
  return healths;
}

}  // namespace graspd::client
