#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "message_stream.hpp"

namespace graspd::simple_message {

struct ControllerState {
  agent::Joints q_rad;
  Status status;
};

/// Listens to the STATE port in a thread of its own, so that a state is never an old one out of a
/// full buffer.
class StateListener {
 public:
  using Time = std::chrono::steady_clock::time_point;

  StateListener(MessageStream stream, int joints_n);
  ~StateListener();
  StateListener(const StateListener&) = delete;
  StateListener& operator=(const StateListener&) = delete;

  /// The first state of which both joints and status came after `after`.
  /// \returns UNAVAILABLE where the connection is lost or garbled, or nothing came before `until`.
  Result<ControllerState> newer_than(Time after, Time until);

 private:
  void listen();
  Result<void> take(const Message& message);

  MessageStream stream_;
  const int joints_n_;

  std::mutex mutex_;
  std::condition_variable changed_;
  ControllerState state_;
  std::int32_t sequence_ = 0;
  Time joints_at_ = Time::min();
  Time status_at_ = Time::min();
  std::optional<Error> broken_;

  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace graspd::simple_message
