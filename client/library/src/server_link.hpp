#pragma once

#include <optional>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "graspd/client/dispatcher.hpp"
#include "graspd/keys/key_files.hpp"
#include "greeting.hpp"

namespace graspd::client {

/// One DEALER to one server, with a monitor that tells when the connection comes and goes: a lost
/// server is known at once, not after a time-out. libzmq never tries again where a handshake was
/// refused, although the key may be allowed by then: such a link gets new sockets after a while.
class ServerLink {
 public:
  /// `context` and `keys` (null: none) must outlive the link.
  /// \throws std::invalid_argument where the endpoint is none.
  ServerLink(zmq::context_t& context, std::string endpoint, std::size_t index,
             const keys::ClientKeys* keys);

  struct Change {
    enum class Kind { kConnected, kDisconnected, kRefused } kind;
    Error why;  ///< of a refusal: UNAUTHENTICATED where asking again is of no use, else UNAVAILABLE
  };
  /// The next change of the connection, in order.
  std::optional<Change> next_change();
  std::optional<zmq::message_t> receive();
  /// \returns false where the socket takes nothing now.
  bool send(std::vector<zmq::message_t> frames);

  /// The server has refused us: new sockets, but not at once.
  void renew_later(TimePoint now);
  void renew_if_due(TimePoint now);
  std::optional<TimePoint> renewal() const { return renewal_; }

  /// Adds what this link has to be woken for.
  void add_items(std::vector<zmq::pollitem_t>& items);

 private:
  void open();
  std::optional<Change> change_of(std::uint16_t event, std::uint32_t value);
  std::optional<Change> change_of_greeting();

  zmq::context_t* context_;
  std::string endpoint_;
  std::size_t index_;
  const keys::ClientKeys* keys_;
  std::size_t renewals_n_ = 0;
  std::optional<TimePoint> renewal_;
  zmq::socket_t socket_;
  zmq::socket_t monitor_;
  std::optional<Greeting> greeting_;  ///< where the server hung up and nobody knows why
};

}  // namespace graspd::client
