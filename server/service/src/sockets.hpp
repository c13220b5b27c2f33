#pragma once

#include <string>
#include <zmq.hpp>

#include "authenticator.hpp"

namespace graspd::service {

/// The front's sockets, with the limits and time-outs that clients count on. Each throws
/// CannotListen. Without an authenticator everybody may come in.
zmq::socket_t bind_data(zmq::context_t& context, const std::string& endpoint,
                        const Authenticator* authenticator);
zmq::socket_t bind_control(zmq::context_t& context, const std::string& endpoint,
                           const Authenticator* authenticator);
zmq::socket_t bind_workers(zmq::context_t& context, const std::string& endpoint);

}  // namespace graspd::service
