#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "graspd/simulation/convex_pieces.hpp"

/// Bullet, made to fit parts of a few centimetres. Its tolerances are meant for bodies of about one
/// unit, so the physics runs in decimetres: one metre is kScale units, and gravity grows with it.
namespace graspd::simulation {

inline constexpr double kScale = 10;
inline constexpr double kMargin_m = 0.0005;
inline constexpr double kGravity_m_s2 = 9.81;

/// The collision shape of one kind of part. Bullet takes a body's origin for its centre of mass:
/// the pieces are shifted so that it is.
struct PartShape {
  std::vector<std::unique_ptr<btConvexHullShape>> pieces;
  std::unique_ptr<btCompoundShape> compound;
  Eigen::Vector3d centre_of_mass_m = Eigen::Vector3d::Zero();  ///< in the part frame
  double radius_m = 0;                                         ///< about the centre of mass
  double mass_kg = 0;
};

PartShape make_part_shape(const parts::Mesh& mesh, const ConvexPiecesOptions& options,
                          double density_kg_m3);

/// What one body does to another at a contact.
struct ContactForce {
  const btCollisionObject* on = nullptr;
  const btCollisionObject* by = nullptr;
  double upward_n = 0;  ///< newtons; negative: pressed down
};

struct Contact {
  const btCollisionObject* a = nullptr;
  const btCollisionObject* b = nullptr;
  double distance_m = 0;   ///< negative: they overlap
  double impulse_n_s = 0;  ///< of the last step, along the normal
};

/// A world with gravity and a bin at its origin.
class BulletWorld {
 public:
  BulletWorld(const Eigen::Vector3d& bin_inner_size_m, double friction, double restitution);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// The shape must outlive the world.
  btRigidBody* add(const PartShape& shape);
  void remove(btRigidBody* body);
  /// A body of this world's materials that is not in the world yet; with mass 0 it never moves.
  std::unique_ptr<btRigidBody> make_body(btCollisionShape* shape, double mass_kg) const;
  void step(double step_s);
  void set_solver_iterations(int iterations_n);
  /// Of any two bodies in contact.
  double deepest_penetration_m() const;
  /// What each contact did in the last step of `step_s`; walls and floor are bodies too.
  std::vector<ContactForce> contact_forces(double step_s) const;
  std::vector<Contact> contacts() const;
  /// From now on no force moves the body: it is where it is put.
  void make_kinematic(btRigidBody* body);
  /// In the next step a kinematic body moves to this pose, and pushes what is in its way; without
  /// an order it stands.
  void move_in_next_step(btRigidBody* body, const Eigen::Isometry3d& T_bin_body);

  /// For bodies and constraints of other owners, who take them out again before the world ends.
  btDiscreteDynamicsWorld& bullet() { return world_; }

 private:
  struct Move {
    btRigidBody* body = nullptr;
    Eigen::Isometry3d T_bin_body;
  };

  static void set_kinematic_velocities(btDynamicsWorld* world, btScalar step_s);
  void add_wall(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& size_m);
  btRigidBody* add_body(btCollisionShape* shape, double mass_kg);

  double friction_;
  double restitution_;
  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btBoxShape>> walls_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<Move> moves_;  ///< of the next step
};

/// Many-cornered hulls rattle on and on: while a pile settles, the air thickens. The share of its
/// speed that a part keeps over a second falls by a factor of ten in each 0.3 s.
/// \param air_damping the least of it
double settling_damping(double settling_s, double air_damping);

/// Pose of the part frame in the bin, from and to a body.
Eigen::Isometry3d pose_of(const btRigidBody& body, const PartShape& shape);
void place(btRigidBody& body, const PartShape& shape, const Eigen::Isometry3d& T_bin_part,
           const Eigen::Vector3d& velocity_m_s);

inline btVector3 to_bullet(const Eigen::Vector3d& v_m) {
  const Eigen::Vector3d v = v_m * kScale;
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

inline Eigen::Vector3d to_metres(const btVector3& v) {
  return Eigen::Vector3d(v.x(), v.y(), v.z()) / kScale;
}

btTransform to_bullet(const Eigen::Isometry3d& T_m);
Eigen::Isometry3d to_metres(const btTransform& T);

}  // namespace graspd::simulation
