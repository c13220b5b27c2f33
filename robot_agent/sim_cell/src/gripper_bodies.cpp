#include "gripper_bodies.hpp"

#include <utility>

#include "jaw_coupling.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kJawMass_kg = 0.15;
constexpr std::array kJawSides{-1, 1};

}  // namespace

GripperBodies::GripperBodies(simulation::BulletWorld& world, const Gripper& gripper,
                             const GripperDrive& drive, double part_friction,
                             const Eigen::Isometry3d& T_bin_grasp)
    : world_(world),
      gripper_(gripper),
      drive_(drive),
      T_bin_grasp_(T_bin_grasp),
      opening_m_(gripper.max_opening_m) {
  // Bullet's slider drives along the line between the bodies' origins: the palm's is where its jaws
  // slide, below its box. (Elsewhere, a turn of the palm would pass for a motion of the jaws.)
  make_box(palm_, "palm", gripper.palm_size_m, part_friction,
           -(gripper.jaw_size_m.z() + gripper.palm_size_m.z()) / 2);
  for (Box& jaw : jaws_) {
    make_box(jaw, "jaw", gripper.jaw_size_m, drive.pad_friction / part_friction);
  }
  move_in_next_step(T_bin_grasp, opening_m_);
  world_.step(0);
}

GripperBodies::~GripperBodies() {
  let_go();
  for (const Box* box : {&palm_, &jaws_[0], &jaws_[1]}) {
    world_.bullet().removeRigidBody(box->body.get());
  }
}

void GripperBodies::make_box(Box& box, std::string name, const Eigen::Vector3d& size_m,
                             double friction, double z_m) {
  box.box = std::make_unique<btBoxShape>(simulation::to_bullet(Eigen::Vector3d(size_m / 2)));
  box.box->setMargin(btScalar(simulation::kMargin_m * simulation::kScale));
  box.shape = std::make_unique<btCompoundShape>();
  box.shape->addChildShape(
      simulation::to_bullet(Eigen::Isometry3d(Eigen::Translation3d(0, 0, z_m))), box.box.get());
  box.body = world_.make_body(box.shape.get(), 0);
  box.label = {BodyLabel::Kind::kRobot, std::move(name), 0};
  box.body->setUserPointer(&box.label);
  box.body->setFriction(btScalar(friction));
  box.body->setRestitution(0);
  box.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT |
                              btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  world_.bullet().addRigidBody(box.body.get(), kRobot, kMovingParts | kFrozenParts | kObstacles);
}

Eigen::Isometry3d GripperBodies::T_grasp_jaw(int side, double opening_m) const {
  const Eigen::Vector3d& jaw_m = gripper_.jaw_size_m;
  return Eigen::Isometry3d(
      Eigen::Translation3d(side * (opening_m + jaw_m.x()) / 2, 0, -jaw_m.z() / 2));
}

void GripperBodies::move_in_next_step(const Eigen::Isometry3d& T_bin_grasp, double opening_m) {
  T_bin_grasp_ = T_bin_grasp;
  const Eigen::Translation3d to_slide(0, 0, -gripper_.jaw_size_m.z() / 2);
  world_.move_in_next_step(palm_.body.get(), T_bin_grasp * to_slide);
  if (is_gripping_) return;
  opening_m_ = opening_m;
  for (std::size_t i = 0; i < jaws_.size(); ++i) {
    world_.move_in_next_step(jaws_[i].body.get(),
                             T_bin_grasp * T_grasp_jaw(kJawSides[i], opening_m));
  }
}

void GripperBodies::grip() {
  if (is_gripping_) return;
  is_gripping_ = true;
  for (std::size_t i = 0; i < jaws_.size(); ++i) {
    set_mass(jaws_[i], kJawMass_kg);
    constraints_.push_back(slider(kJawSides[i]));
  }
  constraints_.push_back(
      std::make_unique<JawCoupling>(*jaws_[0].body, *jaws_[1].body, *palm_.body));
  for (const auto& constraint : constraints_) {
    world_.bullet().addConstraint(constraint.get(), true);
  }
}

void GripperBodies::let_go() {
  if (!is_gripping_) return;
  opening_m_ = opening_m();
  is_gripping_ = false;
  for (const auto& constraint : constraints_) world_.bullet().removeConstraint(constraint.get());
  constraints_.clear();
  for (Box& jaw : jaws_) set_mass(jaw, 0);
}

double GripperBodies::opening_m() const {
  if (!is_gripping_) return opening_m_;
  const Eigen::Vector3d across_m =
      simulation::to_metres(jaws_[1].body->getWorldTransform().getOrigin()) -
      simulation::to_metres(jaws_[0].body->getWorldTransform().getOrigin());
  return across_m.dot(T_bin_grasp_.linear().col(0)) - gripper_.jaw_size_m.x();
}

std::vector<motion::PlacedShape> GripperBodies::shapes() const {
  const Eigen::Translation3d to_palm(0, 0,
                                     -(gripper_.jaw_size_m.z() + gripper_.palm_size_m.z()) / 2);
  const auto pose = [](const Box& box) {
    return simulation::to_metres(box.body->getWorldTransform());
  };
  return {{motion::Box{gripper_.palm_size_m}, pose(palm_) * to_palm},
          {motion::Box{gripper_.jaw_size_m}, pose(jaws_[0])},
          {motion::Box{gripper_.jaw_size_m}, pose(jaws_[1])}};
}

void GripperBodies::set_mass(Box& box, double mass_kg) {
  btVector3 inertia(0, 0, 0);
  if (mass_kg > 0) box.shape->calculateLocalInertia(btScalar(mass_kg), inertia);
  world_.bullet().removeRigidBody(box.body.get());
  box.body->setMassProps(btScalar(mass_kg), inertia);
  const int flags = btCollisionObject::CF_HAS_FRICTION_ANCHOR;
  box.body->setCollisionFlags(mass_kg > 0 ? flags : flags | btCollisionObject::CF_KINEMATIC_OBJECT);
  box.body->updateInertiaTensor();
  box.body->setLinearVelocity(btVector3(0, 0, 0));
  box.body->setAngularVelocity(btVector3(0, 0, 0));
  world_.bullet().addRigidBody(box.body.get(), kRobot, kMovingParts | kFrozenParts | kObstacles);
  // The arm carries the jaws: no weight pulls at the sliders.
  box.body->setGravity(btVector3(0, 0, 0));
}

/// From the palm to a jaw; its x points outwards, so that its position is half the opening.
std::unique_ptr<btTypedConstraint> GripperBodies::slider(int side) {
  Eigen::Isometry3d T_out = Eigen::Isometry3d::Identity();
  if (side < 0) T_out.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  const Eigen::Isometry3d T_palm_out =
      Eigen::Translation3d(side * gripper_.jaw_size_m.x() / 2, 0, 0) * T_out;
  Box& jaw = jaws_[side < 0 ? 0 : 1];
  auto slider = std::make_unique<btSliderConstraint>(*palm_.body, *jaw.body,
                                                     simulation::to_bullet(T_palm_out),
                                                     simulation::to_bullet(T_out), true);
  slider->setUseFrameOffset(false);  // right for bodies on the slider's line, and only then
  slider->setLowerLinLimit(btScalar(gripper_.min_opening_m / 2 * simulation::kScale));
  slider->setUpperLinLimit(btScalar(gripper_.max_opening_m / 2 * simulation::kScale));
  slider->setLowerAngLimit(0);
  slider->setUpperAngLimit(0);
  slider->setPoweredLinMotor(true);
  slider->setTargetLinMotorVelocity(btScalar(-drive_.speed_m_s * simulation::kScale));
  slider->setMaxLinMotorForce(btScalar(drive_.force_n * simulation::kScale));
  return slider;
}

}  // namespace graspd::sim_cell
