#include "server_link.hpp"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "graspd/types/envelope.hpp"

namespace graspd::client {

namespace {

constexpr std::chrono::milliseconds kRenewalPause{1000};

Error refusal_of_key(const std::string& endpoint) {
  return {
      Code::kUnauthenticated,
      fmt::format("{} does not allow this client's key: 'grasp keys allow' it there, and reload "
                  "the server",
                  endpoint)};
}

Error refusal_of_mechanism(const std::string& endpoint, bool with_keys) {
  return {Code::kUnauthenticated,
          fmt::format("{} {}", endpoint,
                      with_keys ? "does not use keys, and this client was told to: leave the keys "
                                  "out, or check that this is the right server"
                                : "lets in nobody without a key: say the server's public key "
                                  "(server_key) and your own (key_file)")};
}

Error no_handshake(const std::string& endpoint, bool with_keys) {
  return {Code::kUnavailable,
          fmt::format("{} hangs up before anybody is let in: {}, and is it a ready grasp_server?",
                      endpoint,
                      with_keys ? "is its public key the one that was given as server_key"
                                : "does it want keys (server_key and key_file)")};
}

}  // namespace

ServerLink::ServerLink(zmq::context_t& context, std::string endpoint, std::size_t index,
                       const keys::ClientKeys* keys)
    : context_(&context), endpoint_(std::move(endpoint)), index_(index), keys_(keys) {
  open();
}

void ServerLink::open() {
  greeting_.reset();
  socket_ = zmq::socket_t(*context_, zmq::socket_type::dealer);
  monitor_ = zmq::socket_t(*context_, zmq::socket_type::pair);
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
  if (keys_ != nullptr) {
    socket_.set(zmq::sockopt::curve_serverkey, keys_->server_key);
    socket_.set(zmq::sockopt::curve_publickey, keys_->own.public_key);
    socket_.set(zmq::sockopt::curve_secretkey, keys_->own.secret_key);
  }

  // Handshakes, not connections: something that listens but is no server never counts as one.
  const std::string address = fmt::format("inproc://monitor-{}-{}", index_, renewals_n_);
  if (zmq_socket_monitor(socket_.handle(), address.c_str(),
                         ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED |
                             ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                             ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL) != 0) {
    throw zmq::error_t();
  }
  monitor_.connect(address);
  try {
    socket_.connect(endpoint_);
  } catch (const zmq::error_t& error) {
    throw std::invalid_argument(fmt::format(
        "'{}' is no server's endpoint ({}); it reads tcp://HOST:PORT, as in tcp://127.0.0.1:5555",
        endpoint_, error.what()));
  }
}

std::optional<ServerLink::Change> ServerLink::next_change() {
  while (true) {
    zmq::message_t event;
    if (!monitor_.recv(event, zmq::recv_flags::dontwait)) return change_of_greeting();
    zmq::message_t address;
    (void)monitor_.recv(address, zmq::recv_flags::none);
    std::uint16_t number = 0;
    std::uint32_t value = 0;
    std::memcpy(&number, event.data(), sizeof number);
    std::memcpy(&value, event.data<char>() + sizeof number, sizeof value);
    if (auto change = change_of(number, value)) return change;
  }
}

std::optional<ServerLink::Change> ServerLink::change_of(std::uint16_t event, std::uint32_t value) {
  using Kind = Change::Kind;
  switch (event) {
    case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
      renewal_.reset();
      greeting_.reset();
      return Change{Kind::kConnected, {}};
    case ZMQ_EVENT_DISCONNECTED:
      return Change{Kind::kDisconnected, {}};
    case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
      return Change{Kind::kRefused, refusal_of_key(endpoint_)};
    case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
      if (value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH) {
        return Change{Kind::kRefused, refusal_of_mechanism(endpoint_, keys_ != nullptr)};
      }
      return Change{Kind::kRefused, no_handshake(endpoint_, keys_ != nullptr)};
    default:
      // A server that goes down; or one of another mechanism, where it was the first to notice.
      if (endpoint_.starts_with("tcp://")) greeting_.emplace(*context_, endpoint_);
      return Change{Kind::kRefused, no_handshake(endpoint_, keys_ != nullptr)};
  }
}

std::optional<ServerLink::Change> ServerLink::change_of_greeting() {
  if (!greeting_) return std::nullopt;
  const auto mechanism = greeting_->mechanism();
  if (!mechanism) return std::nullopt;
  greeting_.reset();
  if (*mechanism == (keys_ != nullptr ? "CURVE" : "NULL")) return std::nullopt;
  return Change{Change::Kind::kRefused, refusal_of_mechanism(endpoint_, keys_ != nullptr)};
}

void ServerLink::add_items(std::vector<zmq::pollitem_t>& items) {
  items.push_back({socket_.handle(), 0, ZMQ_POLLIN, 0});
  items.push_back({monitor_.handle(), 0, ZMQ_POLLIN, 0});
  if (greeting_) items.push_back(greeting_->item());
}

void ServerLink::renew_later(TimePoint now) {
  if (!renewal_) renewal_ = now + kRenewalPause;
}

void ServerLink::renew_if_due(TimePoint now) {
  if (!renewal_ || now < *renewal_) return;
  renewal_.reset();
  ++renewals_n_;
  open();
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
