#pragma once

#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "body_label.hpp"
#include "bullet_world.hpp"
#include "graspd/motion/arm_model.hpp"

namespace graspd::sim_cell {

/// The links of an arm, which are where they are put. What stands with the base may touch what it
/// stands on.
class LinkBodies {
 public:
  /// The world must outlive them.
  LinkBodies(simulation::BulletWorld& world, std::span<const motion::LinkShape> links);
  ~LinkBodies();
  LinkBodies(const LinkBodies&) = delete;
  LinkBodies& operator=(const LinkBodies&) = delete;

  /// In the next step of the world. \param T_base_links one for each link
  void move_in_next_step(std::span<const Eigen::Isometry3d> T_base_links,
                         const Eigen::Isometry3d& T_bin_base);
  /// Of all links, in the world's frame.
  std::vector<motion::PlacedShape> shapes() const;

 private:
  struct Link {
    motion::LinkShape shape;
    std::vector<std::unique_ptr<btCollisionShape>> pieces;
    btCompoundShape compound;
    std::unique_ptr<btRigidBody> body;  ///< none where the link takes up no space
    BodyLabel label;
  };

  simulation::BulletWorld& world_;
  std::deque<Link> links_;
};

}  // namespace graspd::sim_cell
