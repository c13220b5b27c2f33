#pragma once

#include <deque>
#include <string>
#include <vector>

#include "fake_clock.hpp"
#include "graspd/agent/pick_cycle.hpp"

/// A scripted cell: every port does what the script says and writes down what it was told.
namespace graspd::agent::fakes {

inline DepthFrame frame_of(std::uint16_t depth) {
  DepthFrame frame;
  frame.camera = {8, 8, 1000, 1000, 4, 4, {}};  // 1 mm a pixel
  frame.depth.assign(64, depth);
  return frame;
}

/// Gives its frames one after the other, then nothing.
class FakeCamera final : public Camera {
 public:
  explicit FakeCamera(FakeClock& clock) : clock_(clock) {}
  Result<std::optional<DepthFrame>> next() override {
    using namespace std::chrono_literals;
    clock_.advance(33ms);
    if (script.empty()) return std::nullopt;
    auto frame = std::move(script.front());
    script.pop_front();
    return frame;
  }

  std::deque<Result<std::optional<DepthFrame>>> script;

 private:
  FakeClock& clock_;
};

class FakePlanner final : public Planner {
 public:
  explicit FakePlanner(FakeClock& clock) : clock_(clock) {}
  PlanReply plan(const DepthFrame& frame, const PlanRequest& request) override {
    using namespace std::chrono_literals;
    clock_.advance(80ms);
    frames.push_back(frame);
    requests.push_back(request);
    if (script.empty()) throw std::runtime_error("no script");
    auto answer = std::move(script.front());
    script.pop_front();
    return {"0123", std::move(answer)};
  }

  std::deque<Result<PlanAnswer>> script;
  std::vector<DepthFrame> frames;
  std::vector<PlanRequest> requests;

 private:
  FakeClock& clock_;
};

/// Arm and gripper in one, so that the order of what they are told is seen.
class FakeRobot final : public Arm, public Gripper {
 public:
  explicit FakeRobot(FakeClock& clock) : clock_(clock) {}

  void set_surroundings(const Surroundings& now) override { surroundings = now; }
  std::optional<std::string> why_not(std::span<const Motion> path) override {
    knew_surroundings = !surroundings.p_base_m.empty();
    for (const Motion& motion : path) {
      const bool is_too_far = motion.T_base_grasp.translation().norm() > reach_m;
      if (is_too_far || name_of(motion.step) == cannot) {
        return fmt::format("{} is out of reach", name_of(motion.step));
      }
    }
    return std::nullopt;
  }
  Result<void> move(const Motion& motion) override {
    motions.push_back(motion);
    return told(std::string(name_of(motion.step)));
  }
  Result<void> move_out_of_view() override { return told("out_of_view"); }
  Result<void> stop() override {
    told_all.push_back("stop");
    if (!can_be_stopped) return fail(Code::kUnavailable, "no answer for 1 s");
    return {};
  }
  Result<void> open(double opening_width_m) override {
    closed_ = false;
    return told(fmt::format("open {:.3f}", opening_width_m));
  }
  Result<void> close() override {
    closed_ = true;
    return told("close");
  }
  /// As the script says; after its end, what a good gripper says. Every other reading repeats the
  /// one before.
  Result<bool> holds_something() override {
    if (!readings.empty()) {
      const bool held = readings.front();
      readings.pop_front();
      return held;
    }
    if (std::exchange(is_second_reading_, !is_second_reading_)) return held_;
    if (const auto ok = told("holds?"); !ok) return tl::unexpected(ok.error());
    if (closed_ && !holds.empty()) {
      held_ = holds.front();
      holds.pop_front();
    } else {
      held_ = closed_;
    }
    return held_;
  }

  bool can_be_stopped = true;
  Surroundings surroundings;
  bool knew_surroundings = false;  ///< when it was last asked for a way
  double reach_m = 10;
  std::string cannot;         ///< the motion that it has no way for
  std::deque<bool> holds;     ///< whether the closed gripper does, asked twice each; then it does
  std::deque<bool> readings;  ///< of the gripper's sensor, one by one; before `holds`
  std::string fails_at;       ///< the order that fails, "close" or the like
  std::string throws_at;      ///< … that throws
  std::vector<std::string> told_all;
  std::vector<Motion> motions;

 private:
  Result<void> told(const std::string& order) {
    using namespace std::chrono_literals;
    clock_.advance(100ms);
    told_all.push_back(order);
    if (order == throws_at) throw std::runtime_error(order + ": the socket is gone");
    if (order == fails_at) return fail(Code::kInternal, "the {} motor is hot", order);
    return {};
  }

  FakeClock& clock_;
  bool closed_ = false;
  bool held_ = false;
  bool is_second_reading_ = false;
};

class FakeOperator final : public Operator {
 public:
  OperatorSays ask(const std::string& what) override {
    asked.push_back(what);
    if (script.empty()) throw std::runtime_error("nobody answers");
    const OperatorSays answer = script.front();
    script.pop_front();
    return answer;
  }

  std::deque<OperatorSays> script;
  std::vector<std::string> asked;
};

class FakeObserver final : public Observer {
 public:
  void planned(std::uint64_t frame_n, const DepthFrame&, const PlanRequest&,
               const Result<PlanAnswer>&) override {
    planned_frames.push_back(frame_n);
  }
  void finished(const PickRecord& record) override { records.push_back(record); }

  std::vector<std::uint64_t> planned_frames;
  std::vector<PickRecord> records;
};

}  // namespace graspd::agent::fakes
