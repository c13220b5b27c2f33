#include "bullet_world.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>

namespace graspd::simulation {
namespace {

constexpr double kWall_m = 0.05;  // thick, so that nothing is pushed through
constexpr double kGround_m = 4;   // what falls beside the bin lies there
constexpr int kSolverIterations = 30;
constexpr double kRollingFriction = 0.01;
constexpr double kThickening_s = 0.3;
constexpr double kThickest = 5;  // in factors of ten

/// A hull drawn in by Bullet's collision margin, which then brings it back to its true size.
std::unique_ptr<btConvexHullShape> make_hull(const ConvexPiece& piece,
                                             const Eigen::Vector3d& origin_m) {
  std::vector<btVector3> vertices;
  for (const Eigen::Vector3d& p : piece.vertices_m) vertices.push_back(to_bullet(p - origin_m));
  const auto margin = btScalar(kMargin_m * kScale);
  btConvexHullComputer hull;
  hull.compute(vertices.front().m_floats, sizeof(btVector3), int(vertices.size()), margin,
               btScalar(0.4));
  auto shape = std::make_unique<btConvexHullShape>();
  for (int i = 0; i < hull.vertices.size(); ++i) shape->addPoint(hull.vertices[i], false);
  shape->recalcLocalAabb();
  shape->setMargin(margin);
  return shape;
}

}  // namespace

PartShape make_part_shape(const parts::Mesh& mesh, const ConvexPiecesOptions& options,
                          double density_kg_m3) {
  PartShape shape;
  shape.centre_of_mass_m = parts::barycentre_m(mesh);
  shape.mass_kg = std::max(0.001, density_kg_m3 * std::abs(parts::signed_volume_m3(mesh)));
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    shape.radius_m =
        std::max(shape.radius_m, (vertex.cast<double>() - shape.centre_of_mass_m).norm());
  }
  shape.compound = std::make_unique<btCompoundShape>();
  for (const ConvexPiece& piece : convex_pieces(mesh, options)) {
    shape.pieces.push_back(make_hull(piece, shape.centre_of_mass_m));
    shape.compound->addChildShape(btTransform::getIdentity(), shape.pieces.back().get());
  }
  // A balanced tree of the pieces: a tenth less time per step.
  shape.compound->getDynamicAabbTree()->optimizeTopDown();
  return shape;
}

BulletWorld::BulletWorld(const Eigen::Vector3d& bin_inner_size_m, double friction,
                         double restitution)
    : friction_(friction), restitution_(restitution) {
  world_.setGravity(to_bullet(Eigen::Vector3d(0, 0, -kGravity_m_s2)));
  world_.setInternalTickCallback(set_kinematic_velocities, this, true);
  world_.getSolverInfo().m_numIterations = kSolverIterations;
  // Overlap is undone by moving bodies apart, never by speeding them up: piles come to rest.
  world_.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
  world_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  const Eigen::Vector3d& size = bin_inner_size_m;
  add_wall({0, 0, -kWall_m / 2}, {kGround_m, kGround_m, kWall_m});
  for (const double side : {-1.0, 1.0}) {
    add_wall({side * (size.x() + kWall_m) / 2, 0, size.z() / 2},
             {kWall_m, size.y() + 2 * kWall_m, size.z()});
    add_wall({0, side * (size.y() + kWall_m) / 2, size.z() / 2}, {size.x(), kWall_m, size.z()});
  }
}

BulletWorld::~BulletWorld() {
  for (const auto& body : bodies_) world_.removeRigidBody(body.get());
}

void BulletWorld::add_wall(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& size_m) {
  walls_.push_back(std::make_unique<btBoxShape>(to_bullet(size_m / 2)));
  btRigidBody* body = add_body(walls_.back().get(), 0);
  body->setWorldTransform(btTransform(btQuaternion::getIdentity(), to_bullet(centre_m)));
  world_.updateSingleAabb(body);
}

btRigidBody* BulletWorld::add(const PartShape& shape) {
  return add_body(shape.compound.get(), shape.mass_kg);
}

std::unique_ptr<btRigidBody> BulletWorld::make_body(btCollisionShape* shape, double mass_kg) const {
  btVector3 inertia(0, 0, 0);
  if (mass_kg > 0) shape->calculateLocalInertia(btScalar(mass_kg), inertia);
  btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass_kg), nullptr, shape, inertia);
  info.m_friction = btScalar(friction_);
  info.m_restitution = btScalar(restitution_);
  // Without it a round part rocks between the edges of its hull for ever.
  info.m_rollingFriction = btScalar(kRollingFriction);
  info.m_spinningFriction = btScalar(kRollingFriction);
  auto body = std::make_unique<btRigidBody>(info);
  // Sleeping bodies would be "still" without being at rest.
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

btRigidBody* BulletWorld::add_body(btCollisionShape* shape, double mass_kg) {
  bodies_.push_back(make_body(shape, mass_kg));
  world_.addRigidBody(bodies_.back().get());
  return bodies_.back().get();
}

void BulletWorld::remove(btRigidBody* body) {
  world_.removeRigidBody(body);
  std::erase_if(bodies_, [body](const auto& owned) { return owned.get() == body; });
}

void BulletWorld::step(double step_s) {
  world_.stepSimulation(btScalar(step_s), 0);
  for (const Move& move : moves_) {
    const btTransform T = to_bullet(move.T_bin_body);
    move.body->setWorldTransform(T);
    move.body->setInterpolationWorldTransform(T);
  }
  moves_.clear();
}

void BulletWorld::set_solver_iterations(int iterations_n) {
  world_.getSolverInfo().m_numIterations = iterations_n;
}

void BulletWorld::move_in_next_step(btRigidBody* body, const Eigen::Isometry3d& T_bin_body) {
  moves_.push_back({body, T_bin_body});
}

/// During a step a kinematic body is where it was, with the velocity that takes it to where it will
/// be: as a dynamic one. Bullet would put it there first, so that what is fixed to it lags, and
/// would find its velocity from an angle that single precision rounds to 0.7 mrad.
void BulletWorld::set_kinematic_velocities(btDynamicsWorld* world, btScalar step_s) {
  for (const Move& move : static_cast<BulletWorld*>(world->getWorldUserInfo())->moves_) {
    const Eigen::Isometry3d T_now_next =
        to_metres(move.body->getWorldTransform()).inverse() * move.T_bin_body;
    const Eigen::Matrix3d R_bin_now = to_metres(move.body->getWorldTransform()).linear();
    const Eigen::AngleAxisd turn(T_now_next.linear());
    move.body->setLinearVelocity(to_bullet(R_bin_now * T_now_next.translation()) / step_s);
    const Eigen::Vector3d turn_rad = R_bin_now * turn.axis() * turn.angle();
    move.body->setAngularVelocity(
        btVector3(btScalar(turn_rad.x()), btScalar(turn_rad.y()), btScalar(turn_rad.z())) / step_s);
  }
}

double BulletWorld::deepest_penetration_m() const {
  btScalar deepest = 0;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      deepest = std::min(deepest, manifold->getContactPoint(k).getDistance());
    }
  }
  return -double(deepest) / kScale;
}

std::vector<ContactForce> BulletWorld::contact_forces(double step_s) const {
  std::vector<ContactForce> forces;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold->getContactPoint(k);
      const btVector3 impulse = point.m_normalWorldOnB * point.m_appliedImpulse +
                                point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                                point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
      const double upward_n = double(impulse.z()) / step_s / kScale;
      forces.push_back({manifold->getBody0(), manifold->getBody1(), upward_n});
      forces.push_back({manifold->getBody1(), manifold->getBody0(), -upward_n});
    }
  }
  return forces;
}

std::vector<Contact> BulletWorld::contacts() const {
  std::vector<Contact> contacts;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold->getContactPoint(k);
      contacts.push_back({manifold->getBody0(), manifold->getBody1(),
                          double(point.getDistance()) / kScale,
                          double(point.m_appliedImpulse) / kScale});
    }
  }
  return contacts;
}

void BulletWorld::make_kinematic(btRigidBody* body) {
  world_.removeRigidBody(body);
  body->setMassProps(0, btVector3(0, 0, 0));
  body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  world_.addRigidBody(body);
}

double settling_damping(double settling_s, double air_damping) {
  const double tens = std::min(settling_s / kThickening_s, kThickest);
  return std::max(air_damping, 1 - std::pow(0.1, tens));
}

Eigen::Isometry3d pose_of(const btRigidBody& body, const PartShape& shape) {
  return to_metres(body.getWorldTransform()) * Eigen::Translation3d(-shape.centre_of_mass_m);
}

void place(btRigidBody& body, const PartShape& shape, const Eigen::Isometry3d& T_bin_part,
           const Eigen::Vector3d& velocity_m_s) {
  const btTransform T = to_bullet(T_bin_part * Eigen::Translation3d(shape.centre_of_mass_m));
  body.setWorldTransform(T);
  body.setInterpolationWorldTransform(T);
  body.setLinearVelocity(to_bullet(velocity_m_s));
  body.setAngularVelocity(btVector3(0, 0, 0));
  body.clearForces();
}

btTransform to_bullet(const Eigen::Isometry3d& T_m) {
  const Eigen::Quaterniond q(T_m.linear());
  return btTransform(
      btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
      to_bullet(Eigen::Vector3d(T_m.translation())));
}

Eigen::Isometry3d to_metres(const btTransform& T) {
  const btQuaternion q = T.getRotation();
  return Eigen::Translation3d(to_metres(T.getOrigin())) *
         Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized();
}

}  // namespace graspd::simulation
