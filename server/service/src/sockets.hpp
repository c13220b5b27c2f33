#pragma once

#include <string>
#include <zmq.hpp>

namespace graspd::service {

/// The front's sockets, with the options that SERVICE's table fixes. Each throws CannotListen.
zmq::socket_t bind_data(zmq::context_t& context, const std::string& endpoint);
zmq::socket_t bind_control(zmq::context_t& context, const std::string& endpoint);
zmq::socket_t bind_workers(zmq::context_t& context, const std::string& endpoint);

}  // namespace graspd::service
