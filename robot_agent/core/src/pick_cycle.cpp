#include "graspd/agent/pick_cycle.hpp"

#include <algorithm>
#include <stdexcept>

#include "stopwatch.hpp"

/// The cycle itself, and what it does without a robot. pick_cycle_plan.cpp asks for plans and
/// chooses grasps, pick_cycle_robot.cpp moves arm and gripper.
namespace graspd::agent {
namespace {

constexpr std::chrono::milliseconds kFrameTime{33};

State next_state(State from, Event event) {
  for (const Transition& transition : kTransitions) {
    if (transition.from == from && transition.event == event) return transition.to;
  }
  throw std::logic_error(
      fmt::format("pick cycle: no transition from {} on {}", name_of(from), name_of(event)));
}

}  // namespace

PickCycle::PickCycle(Ports ports, Task task, Observer& observer)
    : ports_(ports),
      task_(std::move(task)),
      observer_(observer),
      memory_(task_.failed_spot_radius_m),
      drift_alarm_(task_.drift) {
  if (task_.reactions.any(Reaction::kAsk) && !ports_.cell_operator) {
    throw std::invalid_argument("pick cycle: a reaction is to ask, but there is no operator");
  }
  if (task_.reactions.any(Reaction::kStir) && !task_.request.bin) {
    throw std::invalid_argument("pick cycle: a reaction is to stir, but there is no bin");
  }
}

State PickCycle::step() {
  if (is_over()) throw std::logic_error("pick cycle: step() after its end");
  state_ = next_state(state_, act());
  const bool is_looking_again = state_ == State::kAcquire || state_ == State::kPause;
  if (is_looking_again || state_ == State::kAsk || is_over()) close_record();
  return state_;
}

/// A port that throws must not leave the arm moving.
Event PickCycle::act() {
  try {
    return act_in_state();
  } catch (const std::exception& e) {
    return fault(fmt::format("{}: {}", name_of(state_), e.what()));
  }
}

Event PickCycle::act_in_state() {
  switch (state_) {
    case State::kClearView:
      return clear_view();
    case State::kAcquire:
      return acquire();
    case State::kPlan:
      return plan();
    case State::kPick:
      return pick();
    case State::kPlace:
      return place();
    case State::kStir:
      return stir();
    case State::kAsk:
      return ask();
    case State::kPause:
      return pause();
    case State::kDone:
    case State::kStopped:
      break;
  }
  throw std::logic_error("pick cycle: nothing to do after its end");
}

Event PickCycle::acquire() {
  if (finishing_) {
    reason_ = "asked to stop";
    return Event::kNoMoreFrames;
  }
  const auto start = ports_.clock.now();
  auto frame = fresh_frame();
  if (!frame) return fault("camera: " + frame.error().message);
  if (!*frame) {
    const std::string last = unanswered_ ? ", the last without an answer: " + reason_ : "";
    reason_ = fmt::format("no more frames after {}{}", frames_n_, last);
    return unanswered_ ? Event::kGivenUp : Event::kNoMoreFrames;
  }
  frame_ = *std::move(*frame);
  bin_is_empty_ = false;
  record_.emplace();
  record_->frame_n = frames_n_++;
  record_->start = start;
  record_->acquire = ports_.clock.now() - start;
  if (const auto ok = validate(frame_); !ok) {
    record_->code = ok.error().code;
    record_->message = reason_ = "camera: " + ok.error().message;
    return Event::kBadFrame;
  }
  return Event::kFrame;
}

/// A frame that shows the cell as it is now. One without a stamp is taken for that.
Result<std::optional<DepthFrame>> PickCycle::fresh_frame() {
  for (int old_n = 0;; ++old_n) {
    auto frame = ports_.camera.next();
    const bool is_old = frame && *frame && (*frame)->stamp && *(*frame)->stamp < still_since_;
    if (!is_old) return frame;
    if (old_n == task_.retry.max_old_frames_n) {
      const std::chrono::duration<double> age = still_since_ - *(*frame)->stamp;
      return fail(
          Code::kInternal,
          "{} frames in a row are from before the cell's last motion, the last by {:.2f} s; "
          "check that the camera still delivers, and stamps by the cell's clock",
          old_n + 1, age.count());
    }
    ports_.clock.sleep_for(kFrameTime);
  }
}

Event PickCycle::ask() {
  const OperatorSays says = ports_.cell_operator->ask(reason_);
  still_since_ = ports_.clock.now();
  if (says == OperatorSays::kStop) {
    reason_ = "the operator said stop: " + reason_;
    return Event::kEnough;
  }
  failures_n_ = 0;
  stirs_n_ = 0;
  return Event::kGoOn;
}

Event PickCycle::pause() {
  const RetryPolicy& retry = task_.retry;
  auto length = retry.max_pause;
  if (!bin_is_empty_) {
    ++failures_n_;
    if (has_given_up()) return Event::kGivenUp;
    length = retry.pause;
    for (int i = 1; i < failures_n_ && length < retry.max_pause; ++i) length *= 2;
  }
  ports_.clock.sleep_for(std::min(length, retry.max_pause));
  still_since_ = ports_.clock.now();
  return Event::kRested;
}

/// Says so in `reason_`.
bool PickCycle::has_given_up() {
  if (failures_n_ <= task_.retry.max_failures_n) return false;
  reason_ = fmt::format("{} failures in a row, the last: {}", failures_n_, reason_);
  return true;
}

/// Stops the arm, and says why in `reason_` and the record.
Event PickCycle::fault(const std::string& what) {
  const auto stopped = ports_.arm.stop();
  reason_ = what;
  if (!stopped) {
    reason_ +=
        fmt::format("; the arm could not be stopped ({}): it may be moving, use the emergency stop",
                    stopped.error().message);
  }
  if (record_) {
    record_->message = reason_;
    if (record_->chosen && !record_->verdict) record_->verdict = Verdict::kFault;
  }
  return Event::kFault;
}

void PickCycle::close_record() {
  if (!record_) return;
  record_->end = ports_.clock.now();
  observer_.finished(*record_);
  record_.reset();
}

}  // namespace graspd::agent
