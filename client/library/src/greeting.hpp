#pragma once

#include <optional>
#include <string>
#include <zmq.hpp>

namespace graspd::client {

/// Asks whoever listens at an endpoint which security mechanism it speaks. ZMTP's greetings say so;
/// but where the two sides have none in common, libzmq hangs up on whichever reads the other's
/// first, and that one's own greeting may never arrive. Ours says nothing that could be refused.
class Greeting {
 public:
  /// Returns at once. \param endpoint tcp://…, that a socket has been connected to
  Greeting(zmq::context_t& context, const std::string& endpoint);

  /// "NULL", "CURVE", "PLAIN", …; nothing until the greeting is there.
  std::optional<std::string> mechanism();
  zmq::pollitem_t item() { return {stream_.handle(), 0, ZMQ_POLLIN, 0}; }

 private:
  zmq::socket_t stream_;
  std::string received_;
};

}  // namespace graspd::client
