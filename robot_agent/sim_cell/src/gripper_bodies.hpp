#pragma once

#include <array>
#include <memory>
#include <vector>

#include "body_label.hpp"
#include "bullet_world.hpp"
#include "graspd/sim_cell/physics_cell.hpp"

namespace graspd::sim_cell {

/// A palm and two jaws, in boxes. The palm is where it is put. So are the jaws, until they grip:
/// then they slide along the palm's x, coupled to each other, pushed by no more than their force.
class GripperBodies {
 public:
  /// The world must outlive it. \param part_friction as the world knows it: Bullet takes the
  /// product of two bodies' coefficients.
  GripperBodies(simulation::BulletWorld& world, const Gripper& gripper, const GripperDrive& drive,
                double part_friction, const Eigen::Isometry3d& T_bin_grasp);
  ~GripperBodies();
  GripperBodies(const GripperBodies&) = delete;
  GripperBodies& operator=(const GripperBodies&) = delete;

  const Eigen::Isometry3d& T_bin_grasp() const { return T_bin_grasp_; }
  /// In the next step of the world.
  void move_in_next_step(const Eigen::Isometry3d& T_bin_grasp, double opening_m);
  /// The jaws begin to close; the opening is then what the forces make it.
  void grip();
  /// The jaws hold where they are, and are put there.
  void let_go();
  bool is_gripping() const { return is_gripping_; }
  double opening_m() const;
  /// Palm and jaws, in the world's frame.
  std::vector<motion::PlacedShape> shapes() const;

 private:
  struct Box {
    std::unique_ptr<btBoxShape> box;
    std::unique_ptr<btCompoundShape> shape;  ///< the box, as it lies about the body's origin
    std::unique_ptr<btRigidBody> body;
    BodyLabel label;
  };

  void make_box(Box& box, std::string name, const Eigen::Vector3d& size_m, double friction,
                double z_m = 0);
  Eigen::Isometry3d T_grasp_jaw(int side, double opening_m) const;
  void set_mass(Box& box, double mass_kg);
  std::unique_ptr<btTypedConstraint> slider(int side);

  simulation::BulletWorld& world_;
  Gripper gripper_;
  GripperDrive drive_;
  Eigen::Isometry3d T_bin_grasp_;
  double opening_m_;
  bool is_gripping_ = false;
  Box palm_;
  std::array<Box, 2> jaws_;  ///< at negative and at positive x
  std::vector<std::unique_ptr<btTypedConstraint>> constraints_;
};

}  // namespace graspd::sim_cell
