#include "part_bodies.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace graspd::sim_cell {
namespace {

constexpr double kTouch_m = 0.0005;
/// A part that has moved by this much stirs those that touch it.
constexpr double kStirs_m = 0.0001;
constexpr double kClear_m = 0.01;
constexpr double kStillFor_s = 0.25;
constexpr double kStill_m = 0.0005;
/// Nothing falls faster: thin walls must not pass through each other.
constexpr double kMaxSpeed_m_s = 1.0;

}  // namespace

PartBodies::PartBodies(simulation::BulletWorld& world,
                       const std::vector<simulation::PartShape>& shapes,
                       const simulation::Pile& pile)
    : world_(world), shapes_(shapes) {
  for (const simulation::PiledPart& part : pile.parts) {
    Body& body = bodies_.emplace_back();
    body.kind = part.kind;
    body.label = {BodyLabel::Kind::kPart, fmt::format("part {}", bodies_.size() - 1),
                  bodies_.size() - 1};
    body.body = world_.make_body(shapes_[part.kind].compound.get(), 0);
    body.body->setUserPointer(&body.label);
    place(*body.body, shapes_[part.kind], part.T_bin_part, {0, 0, 0});
    freeze(body);
  }
}

PartBodies::~PartBodies() {
  for (std::size_t i = 0; i < size(); ++i) take_away(i);
}

bool PartBodies::is_any_loose() const {
  return std::ranges::any_of(bodies_, &PartBodies::is_loose);
}

void PartBodies::rest() {
  for (Body& body : bodies_) {
    if (is_loose(body)) freeze(body);
  }
}

Eigen::Isometry3d PartBodies::T_bin_part(std::size_t i) const {
  return simulation::pose_of(*bodies_[i].body, shape(i));
}

Eigen::Vector3d PartBodies::centre_m(std::size_t i) const {
  return simulation::to_metres(bodies_[i].body->getWorldTransform().getOrigin());
}

void PartBodies::take_away(std::size_t i) {
  if (!bodies_[i].is_gone) world_.bullet().removeRigidBody(bodies_[i].body.get());
  bodies_[i].is_gone = true;
}

void PartBodies::set_damping(double damping) {
  damping_ = damping;
  for (Body& body : bodies_) body.body->setDamping(btScalar(damping), btScalar(damping));
}

void PartBodies::update(std::span<const simulation::Contact> contacts, double step_s) {
  pass_on_motion(contacts);
  const auto limit = btScalar(kMaxSpeed_m_s * simulation::kScale);
  for (Body& body : bodies_) {
    if (body.is_frozen || body.is_gone) continue;
    const btVector3 velocity = body.body->getLinearVelocity();
    if (velocity.length() > limit) {
      body.body->setLinearVelocity(velocity * (limit / velocity.length()));
    }
    body.window_s += step_s;
    if (body.window_s < kStillFor_s) continue;
    if (!body.is_touched && !has_moved(body, body.T_window, kStill_m)) {
      freeze(body);
    } else {
      body.window_s = 0;
      body.T_window = simulation::to_metres(body.body->getWorldTransform());
    }
  }
}

bool PartBodies::pause_if_clear(std::span<const simulation::Contact> contacts, double tip_m) {
  const std::vector<bool> hangs = hanging_in_robot(contacts);
  double load_low_m = tip_m;
  double loose_high_m = std::numeric_limits<double>::lowest();
  for (std::size_t i = 0; i < size(); ++i) {
    const Body& body = bodies_[i];
    if (body.is_frozen || body.is_gone) continue;
    if (hangs[i]) load_low_m = std::min(load_low_m, low_m(body));
    if (!hangs[i]) loose_high_m = std::max(loose_high_m, high_m(body));
  }
  if (load_low_m < loose_high_m + kClear_m) return false;
  bool any = false;
  for (std::size_t i = 0; i < size(); ++i) {
    Body& body = bodies_[i];
    if (body.is_frozen || body.is_gone || hangs[i]) continue;
    body.velocity = body.body->getLinearVelocity();
    body.turn_rate = body.body->getAngularVelocity();
    freeze(body);
    body.is_waiting = any = true;
  }
  return any;
}

void PartBodies::resume() {
  for (Body& body : bodies_) {
    if (body.is_waiting) thaw(body);
  }
}

/// Parts that the robot touches, and what touches those, and so on, of the moving ones.
std::vector<bool> PartBodies::hanging_in_robot(
    std::span<const simulation::Contact> contacts) const {
  std::vector<bool> hangs;
  for (const Body& body : bodies_) hangs.push_back(body.is_touched && !body.is_frozen);
  for (bool grew = true; grew;) {
    grew = false;
    for (const simulation::Contact& contact : contacts) {
      const BodyLabel* a = label_of(contact.a);
      const BodyLabel* b = label_of(contact.b);
      if (a == nullptr || b == nullptr || contact.distance_m > kTouch_m) continue;
      if (a->kind != BodyLabel::Kind::kPart || b->kind != BodyLabel::Kind::kPart) continue;
      if (hangs[a->part] == hangs[b->part]) continue;
      const std::size_t other = hangs[a->part] ? b->part : a->part;
      if (bodies_[other].is_frozen) continue;
      hangs[other] = grew = true;
    }
  }
  return hangs;
}

double PartBodies::low_m(const Body& body) const {
  btVector3 low, high;
  body.body->getAabb(low, high);
  return simulation::to_metres(low).z();
}

double PartBodies::high_m(const Body& body) const {
  btVector3 low, high;
  body.body->getAabb(low, high);
  return simulation::to_metres(high).z();
}

void PartBodies::pass_on_motion(std::span<const simulation::Contact> contacts) {
  for (Body& body : bodies_) body.is_touched = false;
  const auto stirs = [this](const BodyLabel& by) {
    if (by.kind == BodyLabel::Kind::kRobot) return true;
    const Body& body = bodies_[by.part];
    return by.kind == BodyLabel::Kind::kPart && !body.is_frozen &&
           has_moved(body, body.T_thawed, kStirs_m);
  };
  const auto meet = [&](const BodyLabel& part, const BodyLabel& other) {
    if (part.kind != BodyLabel::Kind::kPart) return;
    Body& body = bodies_[part.part];
    if (other.kind == BodyLabel::Kind::kRobot) body.is_touched = true;
    if (body.is_frozen && stirs(other)) thaw(body);
  };
  for (const simulation::Contact& contact : contacts) {
    const BodyLabel* a = label_of(contact.a);
    const BodyLabel* b = label_of(contact.b);
    if (a == nullptr || b == nullptr || contact.distance_m > kTouch_m) continue;
    meet(*a, *b);
    meet(*b, *a);
  }
}

bool PartBodies::has_moved(const Body& body, const Eigen::Isometry3d& since, double by_m) const {
  const Eigen::Isometry3d T_since_now =
      since.inverse() * simulation::to_metres(body.body->getWorldTransform());
  const double turn_rad = Eigen::AngleAxisd(T_since_now.linear()).angle();
  return T_since_now.translation().norm() + turn_rad * shapes_[body.kind].radius_m > by_m;
}

void PartBodies::freeze(Body& body) {
  world_.bullet().removeRigidBody(body.body.get());
  body.body->setMassProps(0, btVector3(0, 0, 0));
  body.body->setLinearVelocity(btVector3(0, 0, 0));
  body.body->setAngularVelocity(btVector3(0, 0, 0));
  world_.bullet().addRigidBody(body.body.get(), kFrozenParts, kMovingParts | kRobot);
  body.is_frozen = true;
}

void PartBodies::thaw(Body& body) {
  const simulation::PartShape& shape = shapes_[body.kind];
  btVector3 inertia(0, 0, 0);
  shape.compound->calculateLocalInertia(btScalar(shape.mass_kg), inertia);
  world_.bullet().removeRigidBody(body.body.get());
  body.body->setMassProps(btScalar(shape.mass_kg), inertia);
  body.body->updateInertiaTensor();
  body.body->setDamping(btScalar(damping_), btScalar(damping_));
  world_.bullet().addRigidBody(body.body.get(), kMovingParts, btBroadphaseProxy::AllFilter);
  body.is_frozen = false;
  if (std::exchange(body.is_waiting, false)) {
    body.body->setLinearVelocity(body.velocity);
    body.body->setAngularVelocity(body.turn_rate);
  }
  body.T_thawed = body.T_window = simulation::to_metres(body.body->getWorldTransform());
  body.window_s = 0;
}

}  // namespace graspd::sim_cell
