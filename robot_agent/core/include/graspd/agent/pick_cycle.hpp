#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "graspd/agent/drift_alarm.hpp"
#include "graspd/agent/pick_memory.hpp"
#include "graspd/agent/pick_record.hpp"
#include "graspd/agent/ports.hpp"
#include "graspd/agent/reactions.hpp"
#include "graspd/agent/stir.hpp"
#include "graspd/agent/surroundings.hpp"

namespace graspd::agent {

/// What the cycle is at. CLEAR_VIEW is the first; DONE and STOPPED are the last ones.
enum class State {
  kClearView,
  kAcquire,
  kPlan,
  kPick,
  kPlace,
  kStir,
  kAsk,
  kPause,
  kDone,
  kStopped
};

/// What happened in a state: with the state it decides the next one.
enum class Event {
  kCleared,       ///< the arm is out of view
  kFrame,         ///< a frame to plan on
  kBadFrame,      ///< a frame that no plan can be made of
  kNoMoreFrames,  ///< the recording is over, or the agent was asked to stop
  kGrasp,         ///< PLANNED or UNCHANGED, with a grasp that the arm can take
  kNoneStands,    ///< UNCHANGED, but out of reach: what came to light since may not be
  kShallStop,     ///< nothing to pick, and this is the cell's reaction to it
  kShallWait,     ///< …
  kShallStir,     ///< …
  kShallAsk,      ///< …
  kBinEmpty,      ///< nothing to pick for good: BIN_EMPTY, where the reaction is to stop
  kNoAnswer,      ///< busy, away, too late, or a defect: another try may do
  kRefused,       ///< what was asked for is wrong: another try changes nothing
  kHeld,          ///< the part hangs in the gripper
  kMissed,        ///< the gripper is empty after lifting
  kPlaced,        ///< the part is put down
  kDropped,       ///< the gripper is empty after the transfer
  kStirred,       ///< the pile lies differently
  kNoStroke,      ///< the arm can't stir this pile
  kGoOn,          ///< says the operator
  kEnough,        ///< says the operator
  kRested,        ///< the pause is over
  kGivenUp,       ///< too many failures in a row, or a recording that ends without an answer
  kFault,         ///< camera, arm or gripper reported an error, or something broke
};

/// In state `from`, this event leads to state `to`.
struct Transition {
  State from;
  Event event;
  State to;
};

/// The whole cycle. It starts in CLEAR_VIEW, since nobody knows where the arm is, and always takes
/// a fresh frame after a pause, since the bin may have changed.
inline constexpr Transition kTransitions[] = {
    {State::kClearView, Event::kCleared, State::kAcquire},
    {State::kClearView, Event::kGivenUp, State::kStopped},
    {State::kClearView, Event::kFault, State::kStopped},

    {State::kAcquire, Event::kFrame, State::kPlan},
    {State::kAcquire, Event::kBadFrame, State::kPause},
    {State::kAcquire, Event::kNoMoreFrames, State::kDone},
    {State::kAcquire, Event::kGivenUp, State::kStopped},
    {State::kAcquire, Event::kFault, State::kStopped},

    {State::kPlan, Event::kGrasp, State::kPick},
    {State::kPlan, Event::kNoneStands, State::kPlan},
    {State::kPlan, Event::kBinEmpty, State::kDone},
    {State::kPlan, Event::kShallStop, State::kStopped},
    {State::kPlan, Event::kShallWait, State::kPause},
    {State::kPlan, Event::kShallStir, State::kStir},
    {State::kPlan, Event::kShallAsk, State::kAsk},
    {State::kPlan, Event::kNoAnswer, State::kPause},
    {State::kPlan, Event::kRefused, State::kStopped},
    {State::kPlan, Event::kFault, State::kStopped},

    {State::kPick, Event::kHeld, State::kPlace},
    {State::kPick, Event::kMissed, State::kClearView},
    {State::kPick, Event::kFault, State::kStopped},

    {State::kPlace, Event::kPlaced, State::kClearView},
    {State::kPlace, Event::kDropped, State::kClearView},
    {State::kPlace, Event::kFault, State::kStopped},

    {State::kStir, Event::kStirred, State::kClearView},
    {State::kStir, Event::kNoStroke, State::kPause},
    {State::kStir, Event::kFault, State::kStopped},

    {State::kAsk, Event::kGoOn, State::kAcquire},
    {State::kAsk, Event::kEnough, State::kDone},
    {State::kAsk, Event::kFault, State::kStopped},

    {State::kPause, Event::kRested, State::kAcquire},
    {State::kPause, Event::kGivenUp, State::kStopped},
    {State::kPause, Event::kFault, State::kStopped},
};

/// The cell, as the cycle sees it. All must outlive the cycle.
struct Ports {
  Camera& camera;
  Planner& planner;
  Arm& arm;
  Gripper& gripper;
  Clock& clock;
  Operator* cell_operator = nullptr;  ///< needed where a reaction is to ask
};

/// The pause doubles with every failure in a row. A part that was placed ends the row.
struct RetryPolicy {
  int max_failures_n = 5;  ///< in a row; one more and the cycle stops
  std::chrono::milliseconds pause{500};
  std::chrono::milliseconds max_pause{8000};
  /// A camera may first give what it had in store. It is asked again, a frame time later each.
  int max_old_frames_n = 30;
};

/// What to pick, where to put it, and what to do when that fails.
struct Task {
  PlanRequest request;  ///< what every plan is asked with; the cycle adds last plan, failed spots
  Eigen::Isometry3d T_base_place = Eigen::Isometry3d::Identity();  ///< see `pick_motions`
  double failed_spot_radius_m = 0.02;
  RetryPolicy retry;
  DriftPolicy drift;
  Reactions reactions;
  StirOptions stir;
};

/// Picks parts until the bin is empty, the recording is over, or something is wrong. Whatever goes
/// wrong, an exception of a port included, the arm is stopped, `reason` says why, and the record is
/// closed. Sees ports only. Belongs to one thread.
class PickCycle {
 public:
  /// \throws std::invalid_argument where a reaction needs what is not there: an operator to ask, a
  /// bin to stir in.
  PickCycle(Ports ports, Task task, Observer& observer);

  /// Does what the present state says, and makes one transition. \returns the new state.
  State step();
  State state() const { return state_; }
  bool is_over() const { return state_ == State::kDone || state_ == State::kStopped; }
  /// Why the cycle is over.
  const std::string& reason() const { return reason_; }
  /// Takes no further frame: a part in the gripper is still placed.
  void finish() { finishing_ = true; }

 private:
  Event act();
  Event act_in_state();
  Event clear_view();
  Event acquire();
  Event plan();
  Event pick();
  Event place();
  Event stir();
  Event ask();
  Event pause();

  Result<std::optional<DepthFrame>> fresh_frame();
  Event answered(bool last_plan_was_sent);
  bool choose_grasp();
  Event react();
  template <class Give>
  auto order(Step step, const Give& give);
  Result<void> move(const Motion& motion);
  Result<void> open(Step step, double width_m);
  Result<void> close();
  Result<bool> holds_something();
  Result<void> release(double width_m);
  Result<void> drop_what_was_caught();
  Event lost(Verdict verdict, std::string_view how);
  Event fault(const std::string& what);
  bool has_given_up();
  void close_record();

  Ports ports_;
  Task task_;
  Observer& observer_;

  State state_ = State::kClearView;
  bool finishing_ = false;
  int failures_n_ = 0;                      ///< in a row
  int stirs_n_ = 0;                         ///< in a row
  bool unanswered_ = false;                 ///< the last request was
  bool bin_is_empty_ = false;               ///< says the present frame's answer
  std::chrono::nanoseconds still_since_{};  ///< nothing has moved: older frames show what was
  std::uint64_t frames_n_ = 0;
  std::uint64_t picks_n_ = 0;
  std::string reason_;
  PickMemory memory_;
  DriftAlarm drift_alarm_;
  Surveyor surveyor_;

  // Of the present frame.
  std::optional<PickRecord> record_;
  DepthFrame frame_;
  PlanAnswer answer_;
  Surroundings surroundings_;
  PickMotions motions_;
};

}  // namespace graspd::agent

template <>
struct graspd::EnumNames<graspd::agent::State> {
  using State = agent::State;
  static constexpr std::string_view what = "state";
  static constexpr std::pair<State, std::string_view> values[] = {{State::kClearView, "CLEAR_VIEW"},
                                                                  {State::kAcquire, "ACQUIRE"},
                                                                  {State::kPlan, "PLAN"},
                                                                  {State::kPick, "PICK"},
                                                                  {State::kPlace, "PLACE"},
                                                                  {State::kStir, "STIR"},
                                                                  {State::kAsk, "ASK"},
                                                                  {State::kPause, "PAUSE"},
                                                                  {State::kDone, "DONE"},
                                                                  {State::kStopped, "STOPPED"}};
};

template <>
struct graspd::EnumNames<graspd::agent::Event> {
  using Event = agent::Event;
  static constexpr std::string_view what = "event";
  static constexpr std::pair<Event, std::string_view> values[] = {
      {Event::kCleared, "cleared"},      {Event::kFrame, "frame"},
      {Event::kBadFrame, "bad_frame"},   {Event::kNoMoreFrames, "no_more_frames"},
      {Event::kGrasp, "grasp"},          {Event::kNoneStands, "none_stands"},
      {Event::kShallStop, "shall_stop"}, {Event::kShallWait, "shall_wait"},
      {Event::kShallStir, "shall_stir"}, {Event::kShallAsk, "shall_ask"},
      {Event::kBinEmpty, "bin_empty"},   {Event::kNoAnswer, "no_answer"},
      {Event::kRefused, "refused"},      {Event::kHeld, "held"},
      {Event::kMissed, "missed"},        {Event::kPlaced, "placed"},
      {Event::kDropped, "dropped"},      {Event::kStirred, "stirred"},
      {Event::kNoStroke, "no_stroke"},   {Event::kGoOn, "go_on"},
      {Event::kEnough, "enough"},        {Event::kRested, "rested"},
      {Event::kGivenUp, "given_up"},     {Event::kFault, "fault"}};
};
