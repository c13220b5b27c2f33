#pragma once

#include <memory>
#include <optional>
#include <string>

#include "graspd/agent/ports.hpp"
#include "graspd/motion/motion_parameters.hpp"

namespace graspd::motion {

/// What the arm carries, and how near it may come to things.
struct Posture {
  double opening_m = 0;  ///< of the jaws
  bool holds_part = false;
  /// On a straight motion in the pile. The server has checked the gripper against the pile, and the
  /// part against the walls, by their true shapes, which are not known here: so the held part does
  /// not count, and of the gripper only that it stays clear of bin and table, without a margin.
  bool is_guided = false;
};

/// Arm, gripper and held part among what they must not touch: the bin, the table, what the camera
/// saw, and the arm itself. Links that don't move are never checked. Belongs to one thread.
class CollisionWorld {
 public:
  /// Nothing stands in it yet but what the parameters say.
  CollisionWorld(const ArmModel& arm, const MotionParameters& parameters);
  ~CollisionWorld();
  CollisionWorld(CollisionWorld&&) noexcept;

  /// \param standing_rad where the arm stood when the readings were taken: those on itself are left
  /// out.
  void set_surroundings(const agent::Surroundings& surroundings, const agent::Joints& standing_rad);

  /// "link_4 would touch the bin's wall"; nothing where the arm stands free.
  std::optional<std::string> touch(const agent::Joints& q_rad, const Posture& posture);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::motion
