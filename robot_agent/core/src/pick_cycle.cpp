#include "graspd/agent/pick_cycle.hpp"

#include <algorithm>
#include <stdexcept>

namespace graspd::agent {
namespace {

State next_state(State from, Event event) {
  for (const Transition& transition : kTransitions) {
    if (transition.from == from && transition.event == event) return transition.to;
  }
  throw std::logic_error(
      fmt::format("pick cycle: no transition from {} on {}", name_of(from), name_of(event)));
}

/// Whether the same request may fare better a little later. What is wrong in itself stays wrong.
bool is_worth_retrying(Code code) {
  switch (code) {
    case Code::kInvalidArgument:
    case Code::kUnsupportedVersion:
    case Code::kUnauthenticated:
    case Code::kUnknownPart:
      return false;
    default:
      return true;
  }
}

/// Adds the time until the end of the scope.
class Stopwatch {
 public:
  Stopwatch(Clock& clock, std::chrono::nanoseconds& total)
      : clock_(clock), total_(total), start_(clock.now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { total_ += clock_.now() - start_; }

 private:
  Clock& clock_;
  std::chrono::nanoseconds& total_;
  std::chrono::nanoseconds start_;
};

const Object* find_object(const PlanAnswer& answer, std::uint32_t id) {
  const auto found = std::find_if(answer.objects.begin(), answer.objects.end(),
                                  [id](const Object& object) { return object.id == id; });
  return found == answer.objects.end() ? nullptr : &*found;
}

}  // namespace

PickCycle::PickCycle(Ports ports, Task task, Observer& observer)
    : ports_(ports),
      task_(std::move(task)),
      observer_(observer),
      memory_(task_.failed_spot_radius_m) {}

State PickCycle::step() {
  state_ = next_state(state_, act());
  if (state_ == State::kAcquire || state_ == State::kPause || is_over()) close_record();
  return state_;
}

Event PickCycle::act() {
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
    case State::kPause:
      return pause();
    case State::kDone:
    case State::kStopped:
      break;
  }
  throw std::logic_error("pick cycle: step() after its end");
}

Event PickCycle::clear_view() {
  std::chrono::nanoseconds before_first_frame{};
  const Stopwatch stopwatch(ports_.clock, record_ ? record_->clear_view : before_first_frame);
  if (const auto ok = ports_.arm.move_out_of_view(); !ok) return fault(ok.error(), "arm");
  if (failures_n_ <= task_.retry.max_failures_n) return Event::kCleared;
  reason_ = fmt::format("{} failures in a row, the last: {}", failures_n_, reason_);
  return Event::kGivenUp;
}

Event PickCycle::acquire() {
  if (finishing_) {
    reason_ = "asked to stop";
    return Event::kNoMoreFrames;
  }
  std::chrono::nanoseconds acquiring{};
  auto frame = [&] {
    const Stopwatch stopwatch(ports_.clock, acquiring);
    return ports_.camera.next();
  }();
  if (!frame) return fault(frame.error(), "camera");
  if (!*frame) {
    const std::string last = unanswered_ ? ", the last without an answer: " + reason_ : "";
    reason_ = fmt::format("no more frames after {}{}", frames_n_, last);
    return unanswered_ ? Event::kGivenUp : Event::kNoMoreFrames;
  }
  frame_ = *std::move(*frame);
  record_.emplace();
  record_->frame_n = frames_n_++;
  record_->acquire = acquiring;
  if (const auto ok = validate(frame_); !ok) {
    record_->code = ok.error().code;
    record_->message = reason_ = "camera: " + ok.error().message;
    return Event::kBadFrame;
  }
  return Event::kFrame;
}

Event PickCycle::plan() {
  PlanRequest request = task_.request;
  memory_.add_to(request);
  PlanReply reply = [&] {
    const Stopwatch stopwatch(ports_.clock, record_->plan);
    return ports_.planner.plan(frame_, request);
  }();
  record_->request_id = std::move(reply.request_id);
  if (!reply.answer) {
    const Error& error = reply.answer.error();
    record_->code = error.code;
    record_->message = error.message;
    reason_ = fmt::format("{}: {}", name_of(error.code), error.message);
    unanswered_ = true;
    return is_worth_retrying(error.code) ? Event::kNoAnswer : Event::kRefused;
  }
  unanswered_ = false;
  answer_ = *std::move(reply.answer);
  observer_.planned(record_->frame_n, frame_, request, answer_);
  return answered();
}

Event PickCycle::answered() {
  record_->outcome = answer_.outcome;
  record_->message = answer_.reason;
  record_->objects_n = answer_.objects.size();
  record_->grasps_n = answer_.grasps.size();
  record_->server_timings = answer_.timings;
  if (answer_.outcome == Outcome::kBinEmpty) {
    reason_ = fmt::format("{}: {}", name_of(answer_.outcome), answer_.reason);
    return Event::kBinEmpty;
  }
  if (choose_grasp()) return Event::kGrasp;
  if (!answer_.grasps.empty()) {
    record_->outcome = Outcome::kNoneReachable;
    record_->message = fmt::format(
        "none of {} grasps is within the arm's reach; check "
        "T_base_camera and where the bin stands",
        answer_.grasps.size());
  }
  reason_ = fmt::format("{}: {}", name_of(*record_->outcome), record_->message);
  memory_.nothing_grasped();
  return Event::kNothingToPick;
}

/// The server's best grasp that the arm reaches.
bool PickCycle::choose_grasp() {
  for (std::size_t i = 0; i < answer_.grasps.size(); ++i) {
    const Grasp& grasp = answer_.grasps[i];
    const PickMotions motions = pick_motions(grasp, task_.T_base_place);
    if (ports_.arm.why_not(motions.all())) continue;
    motions_ = motions;
    ChosenGrasp& chosen = record_->chosen.emplace();
    chosen.pick_n = ++picks_n_;
    chosen.rank = i + 1;
    chosen.grasp = grasp;
    if (const Object* object = find_object(answer_, grasp.object_id)) {
      chosen.part_id = object->part_id;
      chosen.grs = object->grs;
    }
    return true;
  }
  return false;
}

Event PickCycle::pick() {
  const Stopwatch stopwatch(ports_.clock, record_->pick);
  Arm& arm = ports_.arm;
  Gripper& gripper = ports_.gripper;
  const Grasp& grasp = record_->chosen->grasp;
  const auto held = arm.move(motions_.pre_grasp)
                        .and_then([&] { return gripper.open(grasp.opening_width_m); })
                        .and_then([&] { return arm.move(motions_.approach); })
                        .and_then([&] { return gripper.close(); })
                        .and_then([&] { return arm.move(motions_.lift); })
                        .and_then([&] { return gripper.holds_something(); });
  if (!held) return fault(held.error(), "pick");
  if (*held) return Event::kHeld;
  return lost(Verdict::kMissed, "the gripper is empty after lifting");
}

Event PickCycle::place() {
  const Stopwatch stopwatch(ports_.clock, record_->place);
  Arm& arm = ports_.arm;
  Gripper& gripper = ports_.gripper;
  const Grasp& grasp = record_->chosen->grasp;
  const auto held = arm.move(motions_.transfer).and_then([&] { return gripper.holds_something(); });
  if (!held) return fault(held.error(), "place");
  if (!*held) return lost(Verdict::kDropped, "the gripper is empty after the transfer");
  const auto released = arm.move(motions_.place)
                            .and_then([&] { return gripper.open(grasp.opening_width_m); })
                            .and_then([&] { return arm.move(motions_.retreat); });
  if (!released) return fault(released.error(), "place");
  record_->verdict = Verdict::kPlaced;
  memory_.placed(answer_, grasp);
  failures_n_ = 0;
  return Event::kPlaced;
}

Event PickCycle::pause() {
  ++failures_n_;
  const RetryPolicy& retry = task_.retry;
  if (failures_n_ > retry.max_failures_n) {
    reason_ = fmt::format("{} failures in a row, the last: {}", failures_n_, reason_);
    return Event::kGivenUp;
  }
  auto length = retry.pause;
  for (int i = 1; i < failures_n_ && length < retry.max_pause; ++i) length *= 2;
  ports_.clock.sleep_for(std::min(length, retry.max_pause));
  return Event::kRested;
}

Event PickCycle::lost(Verdict verdict, std::string_view how) {
  record_->verdict = verdict;
  record_->message = how;
  reason_ = fmt::format("{}: {}", name_of(verdict), how);
  memory_.failed(record_->chosen->grasp);
  ++failures_n_;
  return verdict == Verdict::kMissed ? Event::kMissed : Event::kDropped;
}

Event PickCycle::fault(const Error& error, std::string_view of) {
  ports_.arm.stop();
  reason_ = fmt::format("{}: {}", of, error.message);
  if (record_) {
    record_->message = reason_;
    if (record_->chosen && !record_->verdict) record_->verdict = Verdict::kFault;
  }
  return Event::kFault;
}

void PickCycle::close_record() {
  if (!record_) return;
  observer_.finished(*record_);
  record_.reset();
}

}  // namespace graspd::agent
