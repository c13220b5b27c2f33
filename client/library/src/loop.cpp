#include "loop.hpp"

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <random>
#include <system_error>

#include "graspd/codec/codec.hpp"

namespace graspd::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestSleep{1000};

std::vector<ServerLink> connect(zmq::context_t& context, const std::vector<std::string>& endpoints,
                                const std::optional<keys::ClientKeys>& keys) {
  std::vector<ServerLink> links;
  links.reserve(endpoints.size());
  for (const std::string& endpoint : endpoints) {
    links.emplace_back(context, endpoint, links.size(), keys ? &*keys : nullptr);
  }
  return links;
}

using Payload = std::shared_ptr<const std::vector<std::byte>>;

/// Sent from where it lies: the frame shares it until it is sent, or given up.
zmq::message_t frame_of(const Payload& payload) {
  const auto release = [](void*, void* shared) { delete static_cast<Payload*>(shared); };
  // Nobody writes to it: libzmq has but one kind of pointer.
  return {const_cast<std::byte*>(payload->data()), payload->size(), release, new Payload(payload)};
}

/// Signals are for the program's own threads: one that hits ours would interrupt a socket.
std::thread thread_without_signals(std::function<void()> body) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(body));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
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
                   const DispatchOptions& options)
    : keys_(std::move(keys)),
      links_(connect(context_, endpoints, keys_)),
      dispatcher_(endpoints, options, std::random_device{}()),
      wake_(Clock::now()),
      wake_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
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
    for (std::size_t server = 0; server < links_.size(); ++server) read_server(server);
    send_due();
    std::vector<zmq::pollitem_t> items{{nullptr, wake_fd_, ZMQ_POLLIN, 0}};
    const TimePoint now = Clock::now();
    TimePoint until = std::min(wake_, now + kLongestSleep);
    for (ServerLink& link : links_) {
      link.renew_if_due(now);
      link.add_items(items);
      if (const auto renewal = link.renewal()) until = std::min(until, *renewal);
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
  for (Call& call : posted) {
    const RequestId id = call.request.id;
    dispatcher_.add(id, Clock::now(), call.deadline, call.only);
    calls_[id] = std::move(call);
  }
  return !stop;
}

void Client::Loop::read_server(std::size_t server) {
  // Answers first: what a server sent before it left is still an answer.
  read_answers(server);
  while (auto change = links_[server].next_change()) {
    switch (change->kind) {
      case ServerLink::Change::Kind::kConnected:
        dispatcher_.connected(server);
        break;
      case ServerLink::Change::Kind::kDisconnected:
        dispatcher_.disconnected(server, Clock::now());
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
  links_[server].renew_later(now);
}

void Client::Loop::read_answers(std::size_t server) {
  while (const auto envelope = links_[server].receive()) {
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
    if (links_[attempt.server].send(std::move(frames))) {
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
