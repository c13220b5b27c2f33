#include "greeting.hpp"

#include <string_view>

namespace graspd::client {
namespace {

using namespace std::string_view_literals;

// Of ZMTP 3: the signature and the major version, after which the other side says all of its own.
constexpr std::string_view kBeginning = "\xff\0\0\0\0\0\0\0\x01\x7f\x03"sv;
constexpr std::size_t kMechanism_at = 12;
constexpr std::size_t kMechanism_bytes = 20;  // filled up with zeros

}  // namespace

Greeting::Greeting(zmq::context_t& context, const std::string& endpoint)
    : stream_(context, zmq::socket_type::stream) {
  stream_.set(zmq::sockopt::linger, 0);
  stream_.set(zmq::sockopt::reconnect_ivl, -1);
  stream_.connect(endpoint);
}

std::optional<std::string> Greeting::mechanism() {
  zmq::message_t peer;
  zmq::message_t bytes;
  while (stream_.recv(peer, zmq::recv_flags::dontwait)) {
    (void)stream_.recv(bytes, zmq::recv_flags::none);
    if (!bytes.empty()) {
      received_ += bytes.to_string_view();
    } else if (received_.empty()) {  // connected
      // The C functions: the C++ ones throw where the other side is gone already.
      (void)zmq_send(stream_.handle(), peer.data(), peer.size(), ZMQ_SNDMORE | ZMQ_DONTWAIT);
      (void)zmq_send(stream_.handle(), kBeginning.data(), kBeginning.size(), ZMQ_DONTWAIT);
    }
  }
  if (received_.size() < kMechanism_at + kMechanism_bytes) return std::nullopt;
  const std::string field = received_.substr(kMechanism_at, kMechanism_bytes);
  return field.substr(0, field.find('\0'));
}

}  // namespace graspd::client
