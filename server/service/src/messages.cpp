#include "messages.hpp"

#include <unistd.h>

namespace graspd::service {

bool receive(zmq::socket_t& socket, std::size_t kept, Message& message) {
  message = {};
  // Only the first frame may be missing: the rest of a message is always there.
  for (auto flags = zmq::recv_flags::dontwait;; flags = zmq::recv_flags::none) {
    zmq::message_t frame;
    if (!socket.recv(frame, flags)) return false;
    const bool more = frame.more();
    ++message.arrived_n;
    if (message.frames.size() < kept) message.frames.push_back(std::move(frame));
    if (!more) return true;
  }
}

Sent send(zmq::socket_t& socket, std::vector<zmq::message_t> frames) {
  try {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool last = i + 1 == frames.size();
      const auto flags =
          zmq::send_flags::dontwait | (last ? zmq::send_flags::none : zmq::send_flags::sndmore);
      if (!socket.send(std::move(frames[i]), flags)) return Sent::kWouldBlock;
    }
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return Sent::kUnreachable;
    throw;
  }
  return Sent::kYes;
}

void poll(std::vector<zmq::pollitem_t>& items, std::chrono::milliseconds timeout) {
  try {
    zmq::poll(items, timeout);
  } catch (const zmq::error_t& error) {
    if (error.num() != EINTR) throw;
    for (auto& item : items) item.revents = 0;
  }
}

bool read_event(int fd) {
  if (fd < 0) return false;
  std::vector<zmq::pollitem_t> items{{nullptr, fd, ZMQ_POLLIN, 0}};
  poll(items, std::chrono::milliseconds(0));
  char event[128];  // a signalfd_siginfo, or an eventfd's counter
  return (items[0].revents & ZMQ_POLLIN) != 0 && read(fd, event, sizeof event) > 0;
}

}  // namespace graspd::service
