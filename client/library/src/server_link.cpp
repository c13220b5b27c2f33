#include "server_link.hpp"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "graspd/types/envelope.hpp"

namespace graspd::client {

ServerLink::ServerLink(zmq::context_t& context, const std::string& endpoint, std::size_t index)
    : socket_(context, zmq::socket_type::dealer), monitor_(context, zmq::socket_type::pair) {
  socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(kMaxAnswer_bytes));
  socket_.set(zmq::sockopt::rcvhwm, 64);
  socket_.set(zmq::sockopt::sndhwm, 2);
  socket_.set(zmq::sockopt::handshake_ivl, 5000);
  socket_.set(zmq::sockopt::heartbeat_ivl, 2000);
  socket_.set(zmq::sockopt::heartbeat_timeout, 6000);
  socket_.set(zmq::sockopt::tcp_keepalive, 1);
  socket_.set(zmq::sockopt::tcp_keepalive_idle, 15);
  socket_.set(zmq::sockopt::tcp_keepalive_intvl, 5);
  socket_.set(zmq::sockopt::tcp_keepalive_cnt, 3);
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::immediate, true);
  socket_.set(zmq::sockopt::reconnect_ivl, 100);
  socket_.set(zmq::sockopt::reconnect_ivl_max, 2000);
  socket_.set(zmq::sockopt::connect_timeout, 1000);

  // Handshakes, not connections: something that listens but is no server never counts as one.
  const std::string address = fmt::format("inproc://monitor-{}", index);
  if (zmq_socket_monitor(socket_.handle(), address.c_str(),
                         ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED) != 0) {
    throw zmq::error_t();
  }
  monitor_.connect(address);
  try {
    socket_.connect(endpoint);
  } catch (const zmq::error_t& error) {
    throw std::invalid_argument(fmt::format(
        "'{}' is no server's endpoint ({}); it reads tcp://HOST:PORT, as in tcp://127.0.0.1:5555",
        endpoint, error.what()));
  }
}

ServerLink::Change ServerLink::next_change() {
  zmq::message_t event;
  if (!monitor_.recv(event, zmq::recv_flags::dontwait)) return Change::kNone;
  zmq::message_t address;
  (void)monitor_.recv(address, zmq::recv_flags::none);
  std::uint16_t number = 0;
  std::memcpy(&number, event.data(), sizeof number);
  return number == ZMQ_EVENT_DISCONNECTED ? Change::kDisconnected : Change::kConnected;
}

std::optional<zmq::message_t> ServerLink::receive() {
  zmq::message_t first;
  if (!socket_.recv(first, zmq::recv_flags::dontwait)) return std::nullopt;
  for (bool more = first.more(); more;) {
    zmq::message_t rest;
    (void)socket_.recv(rest, zmq::recv_flags::none);
    more = rest.more();
  }
  return first;
}

bool ServerLink::send(std::vector<zmq::message_t> frames) {
  // Asking for the events makes the socket notice a connection that has just come up.
  if ((socket_.get(zmq::sockopt::events) & ZMQ_POLLOUT) == 0) return false;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto more = i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none;
    if (!socket_.send(std::move(frames[i]), more | zmq::send_flags::dontwait)) return false;
  }
  return true;
}

}  // namespace graspd::client
