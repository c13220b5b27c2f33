#include "handshake_probe.hpp"

#include <chrono>
#include <cstring>
#include <zmq.hpp>

#include "messages.hpp"

namespace graspd::service {
namespace {

constexpr std::chrono::milliseconds kLongestHandshake{3000};
constexpr const char* kMonitor = "inproc://monitor";

/// Where a server that listens on all addresses is reached from its own machine.
std::string reachable(std::string endpoint) {
  for (const auto& [any, one] :
       {std::pair<std::string_view, std::string_view>{"//0.0.0.0:", "//127.0.0.1:"},
        {"//[::]:", "//[::1]:"}}) {
    const std::size_t at = endpoint.find(any);
    if (at != std::string::npos) endpoint.replace(at, any.size(), one);
  }
  return endpoint;
}

Handshake verdict_of(const zmq::message_t& event) {
  std::uint16_t number = 0;
  std::memcpy(&number, event.data(), sizeof number);
  if (number == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) return Handshake::kAccepted;
  if (number == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH) return Handshake::kRefused;
  return Handshake::kNoVerdict;
}

}  // namespace

Handshake try_handshake(const std::string& endpoint, const std::string& server_key,
                        const keys::KeyPair& own) {
  // A context of its own, as any other client's.
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  zmq::socket_t monitor(context, zmq::socket_type::pair);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::curve_serverkey, server_key);
  socket.set(zmq::sockopt::curve_publickey, own.public_key);
  socket.set(zmq::sockopt::curve_secretkey, own.secret_key);
  if (zmq_socket_monitor(socket.handle(), kMonitor,
                         ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH |
                             ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                             ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL) != 0) {
    throw zmq::error_t();
  }
  monitor.connect(kMonitor);
  socket.connect(reachable(endpoint));
  std::vector<zmq::pollitem_t> items{{monitor.handle(), 0, ZMQ_POLLIN, 0}};
  poll(items, kLongestHandshake);
  Message event;
  if (!receive(monitor, 1, event)) return Handshake::kNoVerdict;
  return verdict_of(event.frames[0]);
}

}  // namespace graspd::service
