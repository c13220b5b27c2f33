#include "graspd/simulation/pile_physics.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bullet_world.hpp"

namespace graspd::simulation {
namespace {

/// The solver starts without the forces of a pile at rest: they build up, then they are averaged.
constexpr int kBuildUpSteps = 30;
constexpr int kAveragedSteps = 30;
constexpr double kDamping = 0.5;

struct Piled {
  BulletWorld world;
  std::vector<btRigidBody*> bodies;

  Piled(const std::vector<PartShape>& shapes, const PileOptions& options,
        std::span<const PiledPart> pile, const Eigen::Vector3d& bin_inner_size_m)
      : world(bin_inner_size_m, options.friction, options.restitution) {
    for (const PiledPart& part : pile) {
      bodies.push_back(world.add(shapes[part.kind]));
      place(*bodies.back(), shapes[part.kind], part.T_bin_part, {0, 0, 0});
      bodies.back()->setDamping(btScalar(kDamping), btScalar(kDamping));
    }
  }

  std::vector<Eigen::Vector3d> centres_m() const {
    std::vector<Eigen::Vector3d> centres_m;
    for (const btRigidBody* body : bodies) {
      centres_m.push_back(to_metres(body->getWorldTransform().getOrigin()));
    }
    return centres_m;
  }
};

}  // namespace

struct PilePhysics::Impl {
  std::vector<PartShape> shapes;
  PileOptions options;
};

PilePhysics::PilePhysics(const std::vector<parts::Mesh>& kinds, const PileOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  for (const parts::Mesh& mesh : kinds) {
    impl_->shapes.push_back(make_part_shape(mesh, {}, options.density_kg_m3));
  }
}
PilePhysics::PilePhysics(PilePhysics&&) noexcept = default;
PilePhysics& PilePhysics::operator=(PilePhysics&&) noexcept = default;
PilePhysics::~PilePhysics() = default;

std::vector<Bearing> PilePhysics::bearings(std::span<const PiledPart> pile,
                                           const Eigen::Vector3d& bin_inner_size_m) const {
  Piled piled(impl_->shapes, impl_->options, pile, bin_inner_size_m);
  std::map<const btCollisionObject*, std::uint32_t> index_of;
  for (std::uint32_t i = 0; i < pile.size(); ++i) index_of[piled.bodies[i]] = i;

  for (int i = 0; i < kBuildUpSteps; ++i) piled.world.step(impl_->options.step_s);
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> upward_n;
  for (int i = 0; i < kAveragedSteps; ++i) {
    piled.world.step(impl_->options.step_s);
    for (const ContactForce& force : piled.world.contact_forces(impl_->options.step_s)) {
      const auto on = index_of.find(force.on);
      const auto by = index_of.find(force.by);
      if (on == index_of.end() || by == index_of.end()) continue;
      upward_n[{on->second, by->second}] += force.upward_n / kAveragedSteps;
    }
  }
  std::vector<Bearing> bearings;
  for (const auto& [pair, force_n] : upward_n) {
    const double weight_n = impl_->shapes[pile[pair.first].kind].mass_kg * kGravity_m_s2;
    if (force_n > 0) bearings.push_back({pair.first, pair.second, force_n / weight_n});
  }
  return bearings;
}

std::vector<Moved> PilePhysics::lift(std::size_t lifted, std::span<const PiledPart> pile,
                                     const Eigen::Vector3d& bin_inner_size_m,
                                     const LiftOptions& options) const {
  Piled piled(impl_->shapes, impl_->options, pile, bin_inner_size_m);
  const std::vector<Eigen::Vector3d> before_m = piled.centres_m();
  btRigidBody* body = piled.bodies[lifted];
  piled.world.make_kinematic(body);
  std::vector<Moved> moved(pile.size());
  const double step_m = options.speed_m_s * impl_->options.step_s;
  const auto steps_n = static_cast<int>(std::ceil(options.height_m / step_m));
  for (int step = 0; step < steps_n; ++step) {
    btTransform T = body->getWorldTransform();
    T.getOrigin() += to_bullet({0, 0, step_m});
    body->setWorldTransform(T);
    piled.world.step(impl_->options.step_s);
    const std::vector<Eigen::Vector3d> now_m = piled.centres_m();
    for (std::size_t i = 0; i < pile.size(); ++i) {
      moved[i].rise_m = now_m[i].z() - before_m[i].z();
      moved[i].way_m = std::max(moved[i].way_m, (now_m[i] - before_m[i]).norm());
    }
  }
  return moved;
}

}  // namespace graspd::simulation
