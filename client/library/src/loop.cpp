#include "loop.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <system_error>

#include "graspd/codec/codec.hpp"
#include "thread_without_signals.hpp"

namespace graspd::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestSleep{1000};

using Payload = std::shared_ptr<const std::vector<std::byte>>;

/// Sent from where it lies: the frame shares it until it is sent, or given up.
zmq::message_t frame_of(const Payload& payload) {
  const auto release = [](void*, void* shared) { delete static_cast<Payload*>(shared); };
  // Nobody writes to it: libzmq has but one kind of pointer.
  return {const_cast<std::byte*>(payload->data()), payload->size(), release, new Payload(payload)};
}

/// What goes out for a call: its request, or the recorded envelope with its header.
template <class Call>  // Client::Loop is private
std::string envelope_of(const Call& call) {
  const Request& request = call.request;
  if (call.envelope.empty()) return codec::encode_request(request);
  return codec::with_header(std::as_bytes(std::span(call.envelope)),
                            {request.id, request.attempt, request.cell, request.budget_ms})
      .value();
}

}  // namespace

Client::Loop::Loop(const std::vector<std::string>& endpoints, std::optional<keys::ClientKeys> keys,
                   const DispatchOptions& options, const NameOptions& names)
    : keys_(std::move(keys)),
      resolver_(endpoints, names),
      dispatcher_({}, options, std::random_device{}()),
      wake_(Clock::now()),
      wake_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  try {
    take_servers();  // those without names: what is no endpoint is said here
  } catch (...) {
    close(wake_fd_);
    throw;
  }
  thread_ = thread_without_signals([this] { run(); });
}

Client::Loop::~Loop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  eventfd_write(wake_fd_, 1);
  thread_.join();
  close(wake_fd_);
}

void Client::Loop::post(Call call) {
  {
    const std::lock_guard lock(mutex_);
    posted_.push_back(std::move(call));
  }
  eventfd_write(wake_fd_, 1);
}

void Client::Loop::run() {
  while (take_posted()) {
    for (std::size_t server = 0; server < servers_.size(); ++server) read_server(server);
    send_due();
    close_gone();
    std::vector<zmq::pollitem_t> items{{nullptr, wake_fd_, ZMQ_POLLIN, 0},
                                       {nullptr, resolver_.fd(), ZMQ_POLLIN, 0}};
    const TimePoint now = Clock::now();
    TimePoint until = std::min(wake_, now + kLongestSleep);
    for (const auto& [endpoint, link] : servers_) {
      if (!link) continue;
      link->renew_if_due(now);
      link->add_items(items);
      if (const auto renewal = link->renewal()) until = std::min(until, *renewal);
    }
    zmq::poll(items, std::max(milliseconds(0), std::chrono::ceil<milliseconds>(until - now)));
  }
  while (!calls_.empty()) {
    end(calls_.begin()->first, fail(Code::kUnavailable, "the client was closed before an answer"));
  }
}

bool Client::Loop::take_posted() {
  eventfd_t ignored = 0;
  eventfd_read(wake_fd_, &ignored);
  std::vector<Call> posted;
  bool stop = false;
  {
    const std::lock_guard lock(mutex_);
    posted.swap(posted_);
    stop = stop_;
  }
  take_servers();  // those that calls are for
  for (Call& call : posted) {
    const RequestId id = call.request.id;
    const auto only = find(call.only);
    const bool is_for_nobody = !call.only.empty() && !only;
    dispatcher_.add(id, Clock::now(), is_for_nobody ? TimePoint::min() : call.deadline, only);
    calls_[id] = std::move(call);
  }
  return !stop;
}

/// What names stand for now: servers that are new get a link, and those that are gone lose theirs
/// after the last answer.
void Client::Loop::take_servers() {
  const auto directory = resolver_.take();
  if (!directory) return;
  for (std::size_t server = 0; server < servers_.size(); ++server) {
    const bool is_known = std::ranges::count(directory->endpoints, servers_[server].endpoint) > 0;
    if (servers_[server].link && !is_known) dispatcher_.retire(server);
  }
  for (const std::string& endpoint : directory->endpoints) {
    const auto known = find(endpoint);
    if (known) {
      dispatcher_.keep(*known);
      continue;
    }
    const std::size_t server = dispatcher_.add_server(endpoint);
    servers_.resize(std::max(servers_.size(), server + 1));
    servers_[server] = {endpoint, std::make_unique<ServerLink>(context_, endpoint, links_n_++,
                                                               keys_ ? &*keys_ : nullptr)};
  }
  const bool is_any = !directory->endpoints.empty();
  dispatcher_.no_server(is_any ? std::nullopt : std::optional(directory->unresolved[0].error));
}

std::optional<std::size_t> Client::Loop::find(const std::string& endpoint) const {
  for (std::size_t server = 0; server < servers_.size(); ++server) {
    if (servers_[server].link && servers_[server].endpoint == endpoint) return server;
  }
  return std::nullopt;
}

void Client::Loop::close_gone() {
  for (const std::size_t server : dispatcher_.take_gone()) servers_[server] = {};
}

void Client::Loop::read_server(std::size_t server) {
  if (!servers_[server].link) return;
  // Answers first: what a server sent before it left is still an answer.
  read_answers(server);
  while (auto change = servers_[server].link->next_change()) {
    switch (change->kind) {
      case ServerLink::Change::Kind::kConnected:
        dispatcher_.connected(server);
        break;
      case ServerLink::Change::Kind::kDisconnected:
        dispatcher_.disconnected(server, Clock::now());
        resolver_.look_again();
        break;
      case ServerLink::Change::Kind::kRefused:
        refused(server, change->why);
        break;
    }
  }
}

void Client::Loop::refused(std::size_t server, const Error& why) {
  const TimePoint now = Clock::now();
  dispatcher_.refused(server, why, now);
  servers_[server].link->renew_later(now);
}

void Client::Loop::read_answers(std::size_t server) {
  while (const auto envelope = servers_[server].link->receive()) {
    const codec::Bytes bytes(static_cast<const std::byte*>(envelope->data()), envelope->size());
    Result<Answer> answer = codec::decode_answer(bytes);
    if (!answer) continue;  // not graspd.v1: nobody's answer, and its call will time out
    const RequestId id = answer->id;
    if (answer->code == Code::kUnauthenticated && id == RequestId{}) {
      // Our key was taken out of the list while we were connected: nothing that we say is read.
      refused(server, {answer->code, std::move(answer->message)});
      continue;
    }
    if (auto result = dispatcher_.answered(server, std::move(*answer), Clock::now())) {
      end(id, std::move(*result));
    }
  }
}

void Client::Loop::send_due() {
  const TimePoint now = Clock::now();
  Dispatcher::Step step = dispatcher_.step(now);
  wake_ = step.wake;
  for (const Dispatcher::Attempt& attempt : step.attempts) {
    Call& call = calls_.at(attempt.id);
    call.request.attempt = attempt.number;
    call.request.budget_ms = static_cast<std::uint32_t>(attempt.budget.count());
    const std::string envelope = envelope_of(call);
    std::vector<zmq::message_t> frames;
    frames.emplace_back(envelope.data(), envelope.size());
    if (call.payload) frames.push_back(frame_of(call.payload));
    if (servers_[attempt.server].link->send(std::move(frames))) {
      if (!call.sent) call.sent = Clock::now();
      continue;
    }
    dispatcher_.not_sent(attempt.id, now);
    wake_ = std::min(wake_, now + milliseconds(1));
  }
  for (Dispatcher::Failed& failed : step.failed) {
    end(failed.id, tl::unexpected(std::move(failed.error)));
  }
}

void Client::Loop::end(const RequestId& id, Result<Answer> result) {
  const auto found = calls_.find(id);
  const Call call = std::move(found->second);
  calls_.erase(found);
  call.done(std::move(result), call.sent);
}

}  // namespace graspd::client
