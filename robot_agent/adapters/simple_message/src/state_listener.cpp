#include "state_listener.hpp"

namespace graspd::simple_message {

StateListener::StateListener(MessageStream stream, int joints_n)
    : stream_(std::move(stream)), joints_n_(joints_n), thread_([this] { listen(); }) {}

StateListener::~StateListener() {
  stream_.shut_down();
  thread_.join();
}

void StateListener::listen() {
  while (true) {
    const auto message = stream_.next(std::chrono::hours(1));
    const std::lock_guard lock(mutex_);
    if (!message) {
      broken_ = Error{Code::kUnavailable, message.error().message};
    } else if (*message) {
      if (const auto ok = take(**message); !ok) {
        broken_ = Error{Code::kUnavailable,
                        fmt::format("{} sends {}", stream_.name(), ok.error().message)};
      }
    }
    changed_.notify_all();
    if (broken_) return;
  }
}

Result<void> StateListener::take(const Message& message) {
  if (message.type == kJointPosition) {
    auto position = read_joint_position(message, joints_n_);
    if (!position) return tl::unexpected(position.error());
    // Most controllers send 0 always. One that counts back sends states that were.
    if (position->sequence < sequence_) return {};
    sequence_ = position->sequence;
    state_.q_rad = std::move(position->q_rad);
    joints_at_ = std::chrono::steady_clock::now();
  } else if (message.type == kStatus) {
    const auto status = read_status(message);
    if (!status) return tl::unexpected(status.error());
    state_.status = *status;
    status_at_ = std::chrono::steady_clock::now();
  }
  return {};
}

Result<ControllerState> StateListener::newer_than(Time after, Time until) {
  std::unique_lock lock(mutex_);
  const bool came = changed_.wait_until(
      lock, until, [&] { return broken_ || (joints_at_ > after && status_at_ > after); });
  if (broken_) return tl::unexpected(*broken_);
  if (came) return state_;
  return fail(Code::kUnavailable, "{} fell silent: no new {}", stream_.name(),
              joints_at_ > after ? "status" : "joint positions");
}

}  // namespace graspd::simple_message
