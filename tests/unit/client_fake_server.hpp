#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "graspd/codec/codec.hpp"

/// What the client library is tested against.
namespace graspd::client {

inline Answer healthy(const Request& request) {
  Answer answer;
  answer.id = request.id;
  HealthAnswer health;
  health.part_ids = {"tee"};
  answer.body = health;
  return answer;
}

/// A ROUTER in a thread of its own. It is healthy; the script answers each plan request, or
/// doesn't.
class FakeServer {
 public:
  using Script = std::function<std::vector<Answer>(const Request&)>;

  explicit FakeServer(Script script, const std::string& where = "tcp://127.0.0.1:*")
      : script_(std::move(script)) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.bind(where);
    endpoint = socket_.get(zmq::sockopt::last_endpoint);
    thread_ = std::thread([this] { run(); });
  }
  ~FakeServer() {
    if (thread_.joinable()) stop();
  }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  /// Ends the server. \returns the plan requests it saw.
  std::vector<Request> stop() {
    context_.shutdown();
    thread_.join();
    return seen_;
  }

  std::string endpoint;

 private:
  void run() {
    try {
      while (true) {
        zmq::message_t client;
        zmq::message_t envelope;
        zmq::message_t payload;
        (void)socket_.recv(client);
        (void)socket_.recv(envelope);
        if (envelope.more()) (void)socket_.recv(payload);
        const auto request = codec::decode_request(
            {static_cast<const std::byte*>(envelope.data()), envelope.size()});
        ASSERT_TRUE(request) << request.error().message;
        const bool health = std::holds_alternative<HealthCall>(request->call);
        if (!health) seen_.push_back(*request);
        for (const Answer& answer : health ? std::vector{healthy(*request)} : script_(*request)) {
          socket_.send(zmq::message_t(client.data(), client.size()), zmq::send_flags::sndmore);
          socket_.send(zmq::buffer(codec::encode_answer(answer)), zmq::send_flags::none);
        }
      }
    } catch (const zmq::error_t& error) {
      ASSERT_EQ(error.num(), ETERM);
    }
    socket_.close();
  }

  Script script_;
  std::vector<Request> seen_;  ///< the thread's, until it has ended
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::router};
  std::thread thread_;
};

inline Answer ok(const Request& request, const std::string& reason) {
  Answer answer;
  answer.id = request.id;
  PlanAnswer plan;
  plan.reason = reason;
  answer.body = plan;
  return answer;
}

inline Answer refusal(const Request& request, Code code, std::uint32_t retry_after_ms = 0) {
  Answer answer;
  answer.id = request.id;
  answer.code = code;
  answer.message = "because";
  answer.retry_after_ms = retry_after_ms;
  return answer;
}

inline FakeServer::Script says(const std::string& reason) {
  return [reason](const Request& request) { return std::vector{ok(request, reason)}; };
}

}  // namespace graspd::client
