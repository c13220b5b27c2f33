#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "graspd/agent/pick_memory.hpp"
#include "graspd/agent/pick_record.hpp"
#include "graspd/agent/ports.hpp"

namespace graspd::agent {

enum class State { kClearView, kAcquire, kPlan, kPick, kPlace, kPause, kDone, kStopped };

/// What happened in a state: with the state it decides the next one.
enum class Event {
  kCleared,        ///< the arm is out of view
  kFrame,          ///< a frame to plan on
  kBadFrame,       ///< a frame that no plan can be made of
  kNoMoreFrames,   ///< the recording is over, or the agent was asked to stop
  kGrasp,          ///< PLANNED or UNCHANGED, with a grasp within reach
  kNothingToPick,  ///< NONE_REGISTERED, ALL_IN_COLLISION, NONE_REACHABLE, BIN_NOT_FOUND
  kBinEmpty,       ///< BIN_EMPTY
  kNoAnswer,       ///< busy, away, too late, or a defect: another try may do
  kRefused,        ///< what was asked for is wrong: another try changes nothing
  kHeld,           ///< the part hangs in the gripper
  kMissed,         ///< the gripper is empty after lifting
  kPlaced,         ///< the part is put down
  kDropped,        ///< the gripper is empty after the transfer
  kRested,         ///< the pause is over
  kGivenUp,        ///< too many failures in a row, or a recording that ends without an answer
  kFault,          ///< camera, arm or gripper reported an error
};

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
    {State::kPlan, Event::kBinEmpty, State::kDone},
    {State::kPlan, Event::kNothingToPick, State::kPause},
    {State::kPlan, Event::kNoAnswer, State::kPause},
    {State::kPlan, Event::kRefused, State::kStopped},

    {State::kPick, Event::kHeld, State::kPlace},
    {State::kPick, Event::kMissed, State::kClearView},
    {State::kPick, Event::kFault, State::kStopped},

    {State::kPlace, Event::kPlaced, State::kClearView},
    {State::kPlace, Event::kDropped, State::kClearView},
    {State::kPlace, Event::kFault, State::kStopped},

    {State::kPause, Event::kRested, State::kAcquire},
    {State::kPause, Event::kGivenUp, State::kStopped},
};

struct Ports {
  Camera& camera;
  Planner& planner;
  Arm& arm;
  Gripper& gripper;
  Clock& clock;
};

/// The pause doubles with every failure in a row. A part that was placed ends the row.
struct RetryPolicy {
  int max_failures_n = 5;  ///< in a row; one more and the cycle stops
  std::chrono::milliseconds pause{500};
  std::chrono::milliseconds max_pause{8000};
};

struct Task {
  PlanRequest request;  ///< what every plan is asked with; the cycle adds last plan, failed spots
  Eigen::Isometry3d T_base_place = Eigen::Isometry3d::Identity();  ///< see `pick_motions`
  double failed_spot_radius_m = 0.02;
  RetryPolicy retry;
};

/// Picks parts until the bin is empty, the recording is over, or something is wrong. Sees ports
/// only. Belongs to one thread.
class PickCycle {
 public:
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
  Event clear_view();
  Event acquire();
  Event plan();
  Event pick();
  Event place();
  Event pause();

  Event answered();
  bool choose_grasp();
  Event lost(Verdict verdict, std::string_view how);
  Event fault(const Error& error, std::string_view of);
  void close_record();

  Ports ports_;
  Task task_;
  Observer& observer_;

  State state_ = State::kClearView;
  bool finishing_ = false;
  int failures_n_ = 0;       ///< in a row
  bool unanswered_ = false;  ///< the last request was
  std::uint64_t frames_n_ = 0;
  std::uint64_t picks_n_ = 0;
  std::string reason_;
  PickMemory memory_;

  // Of the present frame.
  std::optional<PickRecord> record_;
  DepthFrame frame_;
  PlanAnswer answer_;
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
                                                                  {State::kPause, "PAUSE"},
                                                                  {State::kDone, "DONE"},
                                                                  {State::kStopped, "STOPPED"}};
};

template <>
struct graspd::EnumNames<graspd::agent::Event> {
  using Event = agent::Event;
  static constexpr std::string_view what = "event";
  static constexpr std::pair<Event, std::string_view> values[] = {
      {Event::kCleared, "cleared"},    {Event::kFrame, "frame"},
      {Event::kBadFrame, "bad_frame"}, {Event::kNoMoreFrames, "no_more_frames"},
      {Event::kGrasp, "grasp"},        {Event::kNothingToPick, "nothing_to_pick"},
      {Event::kBinEmpty, "bin_empty"}, {Event::kNoAnswer, "no_answer"},
      {Event::kRefused, "refused"},    {Event::kHeld, "held"},
      {Event::kMissed, "missed"},      {Event::kPlaced, "placed"},
      {Event::kDropped, "dropped"},    {Event::kRested, "rested"},
      {Event::kGivenUp, "given_up"},   {Event::kFault, "fault"}};
};
