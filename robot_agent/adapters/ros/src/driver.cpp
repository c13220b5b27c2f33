#include "graspd/ros/driver.hpp"

#include <fmt/ranges.h>

#include "topics.hpp"

namespace graspd::ros_arm {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

class Driver final : public agent::JointDriver {
 public:
  explicit Driver(const DriverOptions& options)
      : options_(options),
        topics_(options.joint_names, options.command_topic, options.state_topic) {}

  Result<void> wait_for_arm() {
    const auto until = steady_clock::now() + options_.watchdog;
    while (!topics_.has_listener()) {
      if (steady_clock::now() > until) {
        return fail(Code::kUnavailable, "nobody takes commands on '{}'", topics_.command_topic());
      }
      topics_.poll(10ms);
    }
    return next_state().map([](const agent::Joints&) {});
  }

  Result<agent::Joints> joints() override { return next_state(); }

  Result<void> follow(const agent::JointTrajectory& trajectory) override {
    const auto standing_rad = next_state();
    if (!standing_rad) return tl::unexpected(standing_rad.error());
    if (auto ok = agent::check_trajectory(trajectory, *standing_rad, options_.limits); !ok) {
      return ok;
    }
    send(trajectory);
    auto done = watch(trajectory);
    if (done) return done;
    return fail(done.error().code, "{}; {}", done.error().message,
                request_stop()
                    ? "the arm was stopped"
                    : "it is not seen to stand: the arm may be moving, use the emergency "
                      "stop");
  }

  Result<void> stop() override {
    if (request_stop()) return {};
    return fail(Code::kUnavailable, "the joints on '{}' are not seen to stand for {:.1f} s",
                topics_.state_topic(), std::chrono::duration<double>(options_.watchdog).count());
  }

 private:
  /// One that comes after what waits in the queue.
  Result<agent::Joints> next_state() {
    topics_.poll(0ms);
    const auto before_n = topics_.states_n();
    const auto until = steady_clock::now() + options_.watchdog;
    while (topics_.states_n() == before_n) {
      if (steady_clock::now() > until) {
        return fail(Code::kUnavailable, "no state of the joints {} on '{}' for {:.1f} s",
                    fmt::join(options_.joint_names, ", "), topics_.state_topic(),
                    std::chrono::duration<double>(options_.watchdog).count());
      }
      topics_.poll(10ms);
    }
    const std::vector<double>& q_rad = topics_.q_rad();
    return Eigen::Map<const agent::Joints>(q_rad.data(), static_cast<Eigen::Index>(q_rad.size()));
  }

  void send(const agent::JointTrajectory& trajectory) {
    std::vector<TimedPoint> points;
    for (const agent::JointPoint& point : trajectory) {
      points.push_back({point.t_s, {point.q_rad.begin(), point.q_rad.end()}});
    }
    topics_.command(points);
  }

  Result<void> watch(const agent::JointTrajectory& trajectory) {
    agent::MotionWatch watch(trajectory, options_.limits, steady_clock::now().time_since_epoch());
    while (true) {
      const auto q_rad = next_state();
      if (!q_rad) return tl::unexpected(q_rad.error());
      const auto now = steady_clock::now().time_since_epoch();
      if (watch.has_arrived(*q_rad, std::nullopt, now)) return {};
      if (auto ok = watch.in_time(now); !ok) return ok;
    }
  }

  /// \returns whether two states alike were seen within the watchdog's time.
  bool request_stop() {
    topics_.command({});
    const auto until = steady_clock::now() + options_.watchdog;
    auto before_rad = next_state();
    while (before_rad && steady_clock::now() < until) {
      auto q_rad = next_state();
      if (q_rad && (*q_rad - *before_rad).cwiseAbs().maxCoeff() < agent::kStill_rad) return true;
      before_rad = std::move(q_rad);
    }
    return false;
  }

  DriverOptions options_;
  Topics topics_;
};

}  // namespace

Result<std::unique_ptr<agent::JointDriver>> connect(const DriverOptions& options) {
  if (options.joint_names.empty()) return invalid("no names of joints are given");
  if (!find_master()) return fail(Code::kUnavailable, "no ROS master answers at {}", master_uri());
  auto driver = std::make_unique<Driver>(options);
  if (auto ok = driver->wait_for_arm(); !ok) return tl::unexpected(ok.error());
  return driver;
}

}  // namespace graspd::ros_arm
