#include "graspd/simple_message/driver.hpp"

#include "state_listener.hpp"

namespace graspd::simple_message {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Why a controller can't move; nothing where it can.
std::optional<std::string> trouble_of(const Status& status) {
  if (status.e_stopped == 1) return "the emergency stop is pressed";
  if (status.in_error == 1) {
    return fmt::format("the controller reports error {}", status.error_code);
  }
  if (status.drives_powered == 0) return "the drives have no power";
  if (status.motion_possible == 0) return "the controller says that no motion is possible";
  return std::nullopt;
}

std::optional<bool> in_motion(const Status& status) {
  if (status.in_motion < 0) return std::nullopt;
  return status.in_motion != 0;
}

class Driver final : public agent::JointDriver {
 public:
  Driver(const DriverOptions& options, MessageStream motion, MessageStream state)
      : options_(options), motion_(std::move(motion)), state_(std::move(state), options.joints_n) {}

  Result<agent::Joints> joints() override {
    return next_state().map([](ControllerState state) { return std::move(state.q_rad); });
  }

  Result<void> follow(const agent::JointTrajectory& trajectory) override {
    const auto state = next_state();
    if (!state) return tl::unexpected(state.error());
    if (auto ok = agent::check_trajectory(trajectory, state->q_rad, options_.limits); !ok) {
      return ok;
    }
    if (const auto trouble = trouble_of(state->status)) {
      return fail(Code::kUnavailable, "the arm does not move: {}", *trouble);
    }
    auto done = download(trajectory).and_then([&] { return watch(trajectory); });
    return done ? done : stop_because(done.error());
  }

  Result<void> stop() override { return request_stop(); }

  Result<ControllerState> next_state() {
    const auto now = steady_clock::now();
    return state_.newer_than(now, now + options_.watchdog);
  }

 private:
  Result<void> download(const agent::JointTrajectory& trajectory) {
    for (const TrajectoryPoint& point : download_of(trajectory, options_.full_speed_rad_s)) {
      if (auto ok = motion_.send(to_message(point, kTopic), options_.reply_timeout); !ok) return ok;
    }
    return {};
  }

  /// Until the arm has arrived, or anything is wrong.
  Result<void> watch(const agent::JointTrajectory& trajectory) {
    agent::MotionWatch watch(trajectory, options_.limits, steady_clock::now().time_since_epoch());
    while (true) {
      const auto state = next_state();
      if (!state) return tl::unexpected(state.error());
      if (const auto trouble = trouble_of(state->status)) {
        return fail(Code::kUnavailable, "{}", *trouble);
      }
      const auto now = steady_clock::now().time_since_epoch();
      if (watch.has_arrived(state->q_rad, in_motion(state->status), now)) return {};
      if (auto ok = watch.in_time(now); !ok) return ok;
      if (auto ok = hear_of_points(); !ok) return ok;
    }
  }

  /// Nothing is expected on the MOTION port while the arm moves, but its end or a refusal.
  Result<void> hear_of_points() {
    while (true) {
      const auto message = motion_.next(milliseconds(0));
      if (!message) return tl::unexpected(message.error());
      if (!*message) return {};
      if ((*message)->type == kJointTrajectoryPoint && (*message)->reply == kFailure) {
        return fail(Code::kUnavailable, "the controller refused a point of the trajectory");
      }
    }
  }

  tl::unexpected<Error> stop_because(const Error& error) {
    const auto stopped = request_stop();
    if (stopped) return fail(error.code, "{}; the arm was stopped", error.message);
    return fail(error.code,
                "{}; the stop was not confirmed ({}): the arm may be moving, use the emergency "
                "stop",
                error.message, stopped.error().message);
  }

  /// Once on the connection that stands, once on a new one.
  Result<void> request_stop() {
    auto stopped = request_stop_once();
    if (stopped) return stopped;
    auto again =
        MessageStream::connect(options_.host, options_.motion_port, options_.reply_timeout);
    if (!again) return stopped;
    motion_ = *std::move(again);
    return request_stop_once();
  }

  Result<void> request_stop_once() {
    const TrajectoryPoint stop{kStop, agent::Joints::Zero(options_.joints_n), 0, 0};
    if (auto ok = motion_.send(to_message(stop, kServiceRequest), options_.reply_timeout); !ok) {
      return ok;
    }
    std::string others;
    const auto until = steady_clock::now() + options_.reply_timeout;
    while (true) {
      const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
      const auto reply = motion_.next(std::max(left, milliseconds(0)));
      if (!reply) return tl::unexpected(reply.error());
      if (!*reply) return fail(Code::kUnavailable, "{} did not answer{}", motion_.name(), others);
      const Message& message = **reply;
      if (message.type != kJointTrajectoryPoint || message.comm != kServiceReply) continue;
      const auto sequence =
          message.body.empty() ? kStop : static_cast<std::int32_t>(message.body[0]);
      if (sequence != kStop) {
        others = fmt::format(" the stop, but sequence {}", sequence);
      } else if (message.reply == kSuccess) {
        return {};
      } else {
        return fail(Code::kUnavailable, "{} refused to stop", motion_.name());
      }
    }
  }

  DriverOptions options_;
  MessageStream motion_;
  StateListener state_;
};

}  // namespace

Result<std::unique_ptr<agent::JointDriver>> connect(const DriverOptions& options) {
  if (options.joints_n < 1 || options.joints_n > static_cast<int>(kMaxJoints)) {
    return invalid("simple message knows arms of 1 to {} joints, not of {}", kMaxJoints,
                   options.joints_n);
  }
  auto motion = MessageStream::connect(options.host, options.motion_port, options.watchdog);
  if (!motion) return tl::unexpected(motion.error());
  auto state = MessageStream::connect(options.host, options.state_port, options.watchdog);
  if (!state) return tl::unexpected(state.error());
  auto driver = std::make_unique<Driver>(options, *std::move(motion), *std::move(state));
  if (const auto first = driver->next_state(); !first) return tl::unexpected(first.error());
  return driver;
}

}  // namespace graspd::simple_message
