#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// The two topics of an arm, without ROS's headers.
namespace graspd::ros_arm {

struct TimedPoint {
  double t_s = 0;
  std::vector<double> q_rad;
};

/// Makes the process a node. \returns whether a master answers.
bool find_master();
std::string master_uri();

class Topics {
 public:
  Topics(std::vector<std::string> joint_names, const std::string& command_topic,
         const std::string& state_topic);
  ~Topics();

  std::string command_topic() const;
  std::string state_topic() const;
  /// Whether anybody takes commands.
  bool has_listener() const;
  /// No points: stop.
  void command(const std::vector<TimedPoint>& points);
  /// Takes the states that wait, and waits at most so long for one where none does.
  void poll(std::chrono::milliseconds timeout);

  /// Of the last state that names all the joints.
  const std::vector<double>& q_rad() const { return q_rad_; }
  std::uint64_t states_n() const { return states_n_; }

 private:
  struct Ros;

  std::vector<std::string> joint_names_;
  std::vector<double> q_rad_;
  std::uint64_t states_n_ = 0;
  std::unique_ptr<Ros> ros_;
};

}  // namespace graspd::ros_arm
