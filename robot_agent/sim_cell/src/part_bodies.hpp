#pragma once

#include <deque>
#include <span>
#include <vector>

#include "body_label.hpp"
#include "bullet_world.hpp"
#include "graspd/simulation/pile.hpp"

namespace graspd::sim_cell {

/// The parts of a cell as bodies. A part that nothing stirs is frozen: it is as good as a wall and
/// costs nothing. It thaws when the robot touches it, or a part that has moved since it thawed
/// itself; it freezes where it has lain still for a moment. And what is clear of the robot's load
/// can wait: it is frozen in its motion, and goes on when it is told to, or when it is touched.
class PartBodies {
 public:
  /// World and shapes must outlive the bodies. The pile is taken to be at rest.
  PartBodies(simulation::BulletWorld& world, const std::vector<simulation::PartShape>& shapes,
             const simulation::Pile& pile);
  ~PartBodies();
  PartBodies(const PartBodies&) = delete;
  PartBodies& operator=(const PartBodies&) = delete;

  std::size_t size() const { return bodies_.size(); }
  bool is_frozen(std::size_t i) const { return bodies_[i].is_frozen; }
  /// By the robot, in the last step.
  bool is_touched(std::size_t i) const { return bodies_[i].is_touched; }
  /// Whether any part still moves, but for those that the robot touches.
  bool is_any_loose() const;
  /// Lets those parts stand where they are.
  void rest();
  const simulation::PartShape& shape(std::size_t i) const { return shapes_[bodies_[i].kind]; }
  std::size_t kind(std::size_t i) const { return bodies_[i].kind; }
  Eigen::Isometry3d T_bin_part(std::size_t i) const;
  Eigen::Vector3d centre_m(std::size_t i) const;
  bool is_gone(std::size_t i) const { return bodies_[i].is_gone; }
  /// Out of the world, for ever.
  void take_away(std::size_t i);

  /// Where everything that hangs in the robot, and `tip_m`, is higher than all other moving parts,
  /// these wait. \returns whether they do
  bool pause_if_clear(std::span<const simulation::Contact> contacts, double tip_m);
  /// What waits goes on.
  void resume();

  /// After each step of the world.
  void update(std::span<const simulation::Contact> contacts, double step_s);
  /// The air about the parts that move. \param damping share of the speed lost in a second
  void set_damping(double damping);

 private:
  struct Body {
    std::size_t kind = 0;
    std::unique_ptr<btRigidBody> body;
    BodyLabel label;
    bool is_frozen = true;
    bool is_gone = false;
    Eigen::Isometry3d T_thawed;  ///< where it lay when it thawed
    Eigen::Isometry3d T_window;  ///< where it was when it was last looked whether it lies still
    double window_s = 0;         ///< since then
    bool is_waiting = false;     ///< frozen in motion, with these velocities
    btVector3 velocity, turn_rate;
    bool is_touched = false;
  };

  static bool is_loose(const Body& body) {
    return !body.is_frozen && !body.is_gone && !body.is_touched;
  }
  void freeze(Body& body);
  void thaw(Body& body);
  std::vector<bool> hanging_in_robot(std::span<const simulation::Contact> contacts) const;
  double low_m(const Body& body) const;
  double high_m(const Body& body) const;
  bool has_moved(const Body& body, const Eigen::Isometry3d& since, double by_m) const;
  void pass_on_motion(std::span<const simulation::Contact> contacts);

  simulation::BulletWorld& world_;
  const std::vector<simulation::PartShape>& shapes_;
  std::deque<Body> bodies_;
  double damping_ = 0;
};

}  // namespace graspd::sim_cell
