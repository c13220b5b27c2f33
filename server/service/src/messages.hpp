#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <zmq.hpp>

/// The few things that front and worker both do with ZeroMQ messages.
namespace graspd::service {

/// A multipart message. Frames beyond `kept` are read and thrown away, but counted.
struct Message {
  std::vector<zmq::message_t> frames;
  std::size_t arrived_n = 0;
};

/// Never blocks. \returns false where nothing is there.
bool receive(zmq::socket_t& socket, std::size_t kept, Message& message);

enum class Sent { kYes, kWouldBlock, kUnreachable };
/// Never blocks.
Sent send(zmq::socket_t& socket, std::vector<zmq::message_t> frames);

/// zmq::poll that takes an interruption for "nothing yet".
void poll(std::vector<zmq::pollitem_t>& items, std::chrono::milliseconds timeout);

/// Reads an event of a signalfd or eventfd. Never blocks. \returns false where there is none.
bool read_event(int fd);

inline std::span<const std::byte> bytes_of(const zmq::message_t& frame) {
  return {static_cast<const std::byte*>(frame.data()), frame.size()};
}

inline zmq::message_t frame_of(std::string_view text) { return {text.data(), text.size()}; }

/// Numbers between front and workers, which are the same machine.
inline zmq::message_t frame_of(std::uint64_t number) { return {&number, sizeof number}; }

inline std::uint64_t number_of(const zmq::message_t& frame) {
  std::uint64_t number = 0;
  std::memcpy(&number, frame.data(), std::min(sizeof number, frame.size()));
  return number;
}

/// Between front and workers, frames after the routing id:
///     front → worker   PLAN  ticket  queue_ns  envelope  payload
///                      STOP
///     worker → front   READY  catalogue hash  config hash
///                      BEAT
///                      UNFIT  why, as a sentence: it will never be READY
///                      DONE  ticket  code  work report  encoded answer
namespace verb {
inline constexpr std::string_view kPlan = "PLAN";
inline constexpr std::string_view kStop = "STOP";
inline constexpr std::string_view kReady = "READY";
inline constexpr std::string_view kBeat = "BEAT";
inline constexpr std::string_view kUnfit = "UNFIT";
inline constexpr std::string_view kDone = "DONE";
}  // namespace verb

inline constexpr std::chrono::milliseconds kBeatInterval{1000};

}  // namespace graspd::service
