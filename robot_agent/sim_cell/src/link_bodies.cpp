#include "link_bodies.hpp"

#include <stdexcept>

namespace graspd::sim_cell {
namespace {

struct MakeShape {
  std::unique_ptr<btCollisionShape> operator()(const motion::Box& box) const {
    return std::make_unique<btBoxShape>(simulation::to_bullet(Eigen::Vector3d(box.size_m / 2)));
  }
  std::unique_ptr<btCollisionShape> operator()(const motion::Cylinder& cylinder) const {
    return std::make_unique<btCylinderShapeZ>(simulation::to_bullet(
        Eigen::Vector3d(cylinder.radius_m, cylinder.radius_m, cylinder.length_m / 2)));
  }
  std::unique_ptr<btCollisionShape> operator()(const motion::Sphere& sphere) const {
    return std::make_unique<btSphereShape>(btScalar(sphere.radius_m * simulation::kScale));
  }
};

}  // namespace

LinkBodies::LinkBodies(simulation::BulletWorld& world, std::span<const motion::LinkShape> links)
    : world_(world) {
  for (const motion::LinkShape& shape : links) {
    Link& link = links_.emplace_back();
    link.shape = shape;
    if (shape.shapes.empty()) continue;
    for (const motion::PlacedShape& piece : shape.shapes) {
      link.pieces.push_back(std::visit(MakeShape{}, piece.shape));
      link.compound.addChildShape(simulation::to_bullet(piece.T_link_shape),
                                  link.pieces.back().get());
    }
    link.body = world_.make_body(&link.compound, 0);
    link.label = {BodyLabel::Kind::kRobot, shape.name, 0};
    link.body->setUserPointer(&link.label);
    link.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    const int parts = kMovingParts | kFrozenParts;
    world_.bullet().addRigidBody(link.body.get(), kRobot,
                                 shape.joints_before_n == 0 ? parts : parts | kObstacles);
  }
}

LinkBodies::~LinkBodies() {
  for (const Link& link : links_) {
    if (link.body) world_.bullet().removeRigidBody(link.body.get());
  }
}

std::vector<motion::PlacedShape> LinkBodies::shapes() const {
  std::vector<motion::PlacedShape> shapes;
  for (const Link& link : links_) {
    for (const motion::PlacedShape& piece : link.shape.shapes) {
      shapes.push_back({piece.shape, simulation::to_metres(link.body->getWorldTransform()) *
                                         piece.T_link_shape});
    }
  }
  return shapes;
}

void LinkBodies::move_in_next_step(std::span<const Eigen::Isometry3d> T_base_links,
                                   const Eigen::Isometry3d& T_bin_base) {
  if (T_base_links.size() != links_.size()) {
    throw std::invalid_argument(fmt::format("robot pose: {} poses for an arm of {} links",
                                            T_base_links.size(), links_.size()));
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (!links_[i].body) continue;
    world_.move_in_next_step(links_[i].body.get(), T_bin_base * T_base_links[i]);
  }
}

}  // namespace graspd::sim_cell
