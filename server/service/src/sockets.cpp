#include "sockets.hpp"

#include <fmt/format.h>

#include "graspd/service/front.hpp"
#include "graspd/types/envelope.hpp"

namespace graspd::service {
namespace {

// Room for ZMTP's own bytes beside the largest frame that is read.
constexpr int kFraming_bytes = 33;

void bind(zmq::socket_t& socket, const std::string& endpoint) {
  try {
    socket.bind(endpoint);
  } catch (const zmq::error_t& error) {
    if (error.num() == EADDRINUSE) {
      throw CannotListen(fmt::format(
          "{} is in use: another server may be running there; stop it, or listen on another port "
          "(port 0 takes a free one)",
          endpoint));
    }
    if (error.num() == EACCES) {
      throw CannotListen(
          fmt::format("no permission to listen on {}: ports below 1024 need privileges", endpoint));
    }
    throw CannotListen(fmt::format("cannot listen on {}: {}; say an address of this machine",
                                   endpoint, error.what()));
  }
}

zmq::socket_t client_router(zmq::context_t& context, const std::string& endpoint,
                            std::size_t largest_bytes, const Authenticator* authenticator) {
  zmq::socket_t socket(context, zmq::socket_type::router);
  if (authenticator != nullptr) authenticator->protect(socket);
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(largest_bytes + kFraming_bytes));
  socket.set(zmq::sockopt::rcvhwm, 4);
  socket.set(zmq::sockopt::sndhwm, 64);
  // Who does not fit into it waits for a second and more: all cells come at once after a restart.
  socket.set(zmq::sockopt::backlog, 1024);
  socket.set(zmq::sockopt::handshake_ivl, 2000);
  socket.set(zmq::sockopt::heartbeat_ivl, 10'000);
  socket.set(zmq::sockopt::heartbeat_timeout, 30'000);
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, 15);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, 5);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, 3);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::router_mandatory, true);
  bind(socket, endpoint);
  return socket;
}

}  // namespace

zmq::socket_t bind_data(zmq::context_t& context, const std::string& endpoint,
                        const Authenticator* authenticator) {
  return client_router(context, endpoint, kMaxPayload_bytes, authenticator);
}

zmq::socket_t bind_control(zmq::context_t& context, const std::string& endpoint,
                           const Authenticator* authenticator) {
  return client_router(context, endpoint, kMaxRequestEnvelope_bytes, authenticator);
}

zmq::socket_t bind_workers(zmq::context_t& context, const std::string& endpoint) {
  zmq::socket_t socket(context, zmq::socket_type::router);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::router_mandatory, true);
  bind(socket, endpoint);
  return socket;
}

}  // namespace graspd::service
