#include "graspd/client/client.hpp"

#include <sys/random.h>

#include <cerrno>
#include <system_error>

#include "graspd/codec/codec.hpp"
#include "loop.hpp"

namespace graspd::client {
namespace {

template <class T>
std::future<Result<T>> ready_future(Error error) {
  std::promise<Result<T>> promise;
  promise.set_value(tl::unexpected(std::move(error)));
  return promise.get_future();
}

/// The part of an answer that was asked for.
template <class T>
Result<T> body_of(Result<Answer> answer) {
  if (!answer) return tl::unexpected(std::move(answer.error()));
  if (auto* body = std::get_if<T>(&answer->body)) return std::move(*body);
  return fail(Code::kInternal, "the server answered another question than was asked");
}

}  // namespace

RequestId new_request_id() {
  RequestId id;
  if (getrandom(id.data(), id.size(), 0) != static_cast<ssize_t>(id.size())) {
    throw std::system_error(errno, std::generic_category(), "getrandom");
  }
  return id;
}

Client::Client(const std::vector<std::string>& endpoints, ClientOptions options)
    : endpoints_(endpoints),
      options_(std::move(options)),
      loop_(std::make_unique<Loop>(endpoints_, options_.keys, options_.dispatch)) {}

Client::~Client() = default;

Result<PlanAnswer> Client::plan(const DepthFrame& frame, const PlanRequest& request,
                                std::chrono::milliseconds budget, const RequestId& id) {
  return submit(frame, request, budget, id).get();
}

std::future<Result<PlanAnswer>> Client::submit(const DepthFrame& frame, const PlanRequest& request,
                                               std::chrono::milliseconds budget,
                                               const RequestId& id) {
  if (auto ok = validate(frame); !ok) return ready_future<PlanAnswer>(ok.error());
  if (auto ok = validate(request); !ok) return ready_future<PlanAnswer>(ok.error());
  codec::EncodedFrame encoded = codec::encode_frame(frame, options_.encoding);

  Loop::Call call;
  call.request.id = id;
  call.request.cell = options_.cell;
  call.request.call = PlanCall{encoded.description, request};
  call.payload = std::make_shared<const std::vector<std::byte>>(std::move(encoded.payload));
  call.deadline = Clock::now() + budget;
  auto promise = std::make_shared<std::promise<Result<PlanAnswer>>>();
  call.done = [promise](Result<Answer> answer) {
    promise->set_value(body_of<PlanAnswer>(std::move(answer)));
  };
  loop_->post(std::move(call));
  return promise->get_future();
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
  call.done = [promise](Result<Answer> answer) {
    promise->set_value(body_of<PlanAnswer>(std::move(answer)));
  };
  loop_->post(std::move(call));
  return promise->get_future().get();
}

std::vector<ServerHealth> Client::health(std::chrono::milliseconds budget) {
  std::vector<std::future<Result<HealthAnswer>>> futures;
  for (std::size_t server = 0; server < endpoints_.size(); ++server) {
    Loop::Call call;
    call.request.id = new_request_id();
    call.request.cell = options_.cell;
    call.request.call = HealthCall{};
    call.deadline = Clock::now() + budget;
    call.only = server;
    auto promise = std::make_shared<std::promise<Result<HealthAnswer>>>();
    call.done = [promise](Result<Answer> answer) {
      promise->set_value(body_of<HealthAnswer>(std::move(answer)));
    };
    futures.push_back(promise->get_future());
    loop_->post(std::move(call));
  }
  std::vector<ServerHealth> healths;
  for (std::size_t server = 0; server < endpoints_.size(); ++server) {
    healths.push_back({endpoints_[server], futures[server].get()});
  }
  return healths;
}

}  // namespace graspd::client
