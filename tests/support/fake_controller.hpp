#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace graspd::testing {

/// What a controller does wrong after a fifth of a motion.
enum class Misbehaviour {
  kNone,
  kFallsSilent,     ///< no more states; the connections stay
  kStopsStatus,     ///< joint positions only
  kClosesState,     ///< drops the STATE connection, and moves on
  kClosesMotion,    ///< drops the MOTION connection, and moves on
  kVanishes,        ///< both, and nobody listens any more
  kEmergencyStop,   ///< somebody pressed it: the arm halts and says so
  kReportsError,    ///< halts with error 1234
  kLosesPower,      ///< halts, drives off
  kGarbageOnState,  ///< bytes that are no message
  kGarbageOnMotion,
  kWrongLength,   ///< a joint position that is too short
  kCountsBack,    ///< numbers its states, and then sends old ones again
  kHalts,         ///< stands short of the goal, and says nothing of it
  kNeverSettles,  ///< at the goal, yet in motion for ever
  kRefusesPoint,  ///< answers a point with FAILURE
};

/// How it answers a stop. It does stop, but for the last two.
enum class StopAnswer { kConfirms, kOtherSequence, kNothing, kRefuses };

/// The controller of an arm as simple message knows it, on two ports of this machine: an
/// implementation of its own, so that a misreading of the protocol does not cancel out. Moves along
/// what was downloaded, in real time.
class FakeController {
 public:
  struct Point {
    std::int32_t sequence = 0;
    std::vector<float> q_rad;
    float velocity = 0;
    float duration_s = 0;
  };

  explicit FakeController(std::vector<float> q_rad);
  ~FakeController();
  FakeController(const FakeController&) = delete;
  FakeController& operator=(const FakeController&) = delete;

  std::uint16_t motion_port() const { return motion_.port; }
  std::uint16_t state_port() const { return state_.port; }

  /// In each motion from now on, but for so many that go well before.
  void misbehave(Misbehaviour misbehaviour, int good_motions_n = 0) {
    misbehaviour_ = misbehaviour;
    good_motions_n_ = good_motions_n;
  }
  void answer_stops(StopAnswer answer) { stop_answer_ = answer; }
  /// Sends every message byte by byte, and states with PINGs between them.
  void dribble() { dribbles_ = true; }
  void set_e_stop(bool pressed) { e_stopped_ = pressed; }
  /// A controller that can't say whether it moves.
  void hide_motion() { hides_motion_ = true; }

  std::vector<float> joints() const;
  bool is_moving() const;
  int stops_n() const { return stops_n_; }
  /// Of the last download.
  std::vector<Point> points() const;

 private:
  /// A port with at most one connection.
  struct Port {
    int listener = -1;
    int connection = -1;
    std::uint16_t port = 0;
  };

  void run();
  void read_motion();
  void take(const std::vector<std::int32_t>& words);
  void start_motion();
  void advance(double seconds);
  void go_wrong();
  void halt();
  void send_state();
  void send(Port& port, const std::vector<std::int32_t>& words);
  void send_bytes(Port& port, const std::vector<std::uint8_t>& bytes);
  std::vector<std::int32_t> status() const;
  std::vector<std::int32_t> joint_position();

  Port motion_;
  Port state_;
  std::vector<std::uint8_t> received_;

  mutable std::mutex mutex_;
  std::vector<float> q_rad_;
  std::vector<Point> downloading_;
  std::vector<Point> points_;
  double moved_s_ = 0;  ///< into the points' time
  bool moves_ = false;

  std::atomic<Misbehaviour> misbehaviour_ = Misbehaviour::kNone;
  std::atomic<int> good_motions_n_ = 0;
  std::atomic<StopAnswer> stop_answer_ = StopAnswer::kConfirms;
  std::atomic<bool> dribbles_ = false;
  std::atomic<bool> e_stopped_ = false;
  std::atomic<bool> hides_motion_ = false;
  std::atomic<int> stops_n_ = 0;
  std::atomic<bool> over_ = false;
  bool goes_well_ = true;  ///< this motion
  bool went_wrong_ = false;
  std::int32_t sequence_ = 0;

  std::thread thread_;
};

}  // namespace graspd::testing
