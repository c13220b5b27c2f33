#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

namespace graspd::testing {

/// A ROS master of this test program's own: a `rosmaster` process, as long as the program runs.
void need_ros_master();

/// The ROS side of an arm: moves along what comes on `joint_path_command`, says where it is on
/// `joint_states`.
class FakeRosArm {
 public:
  explicit FakeRosArm(std::vector<double> q_rad);
  ~FakeRosArm();

  static std::vector<std::string> joint_names();
  /// Goes on moving, and says no more where it is.
  void fall_silent_in_motion() { silent_in_motion_ = true; }
  /// Takes a command for less than it asks.
  void halt_in_motion() { halts_in_motion_ = true; }
  void ignore_stops() { ignores_stops_ = true; }
  bool is_moving() const { return moves_; }
  int stops_n() const { return stops_n_; }

 private:
  struct Ros;
  void run();
  void advance(double seconds);

  std::unique_ptr<Ros> ros_;
  std::vector<double> q_rad_;
  std::atomic<bool> moves_ = false;
  std::atomic<bool> silent_in_motion_ = false;
  std::atomic<bool> halts_in_motion_ = false;
  std::atomic<bool> ignores_stops_ = false;
  std::atomic<int> stops_n_ = 0;
  std::atomic<bool> over_ = false;
};

}  // namespace graspd::testing
