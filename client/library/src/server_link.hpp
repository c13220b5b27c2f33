#pragma once

#include <optional>
#include <string>
#include <vector>
#include <zmq.hpp>

namespace graspd::client {

/// One DEALER to one server, with a monitor that tells when the connection comes and goes: a lost
/// server is known at once, not after a time-out.
class ServerLink {
 public:
  /// \throws std::invalid_argument where the endpoint is none.
  ServerLink(zmq::context_t& context, const std::string& endpoint, std::size_t index);

  enum class Change { kNone, kConnected, kDisconnected };
  /// The next change of the connection, in order.
  Change next_change();
  std::optional<zmq::message_t> receive();
  /// \returns false where the socket takes nothing now.
  bool send(std::vector<zmq::message_t> frames);

  zmq::pollitem_t socket_item() { return {socket_.handle(), 0, ZMQ_POLLIN, 0}; }
  zmq::pollitem_t monitor_item() { return {monitor_.handle(), 0, ZMQ_POLLIN, 0}; }

 private:
  zmq::socket_t socket_;
  zmq::socket_t monitor_;
};

}  // namespace graspd::client
