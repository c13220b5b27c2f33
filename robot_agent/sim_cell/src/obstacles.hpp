#pragma once

#include <deque>
#include <memory>
#include <string>

#include "body_label.hpp"
#include "bullet_world.hpp"
#include "graspd/types/request.hpp"

namespace graspd::sim_cell {

/// What stands in a cell: the table, the bin as the robot meets it (the parts meet the world's own,
/// thicker walls) and the box that parts are put into.
class Obstacles {
 public:
  /// The world must outlive them. Its frame is the bin's.
  Obstacles(simulation::BulletWorld& world, const Bin& bin, const Bin& place);
  ~Obstacles();
  Obstacles(const Obstacles&) = delete;
  Obstacles& operator=(const Obstacles&) = delete;

 private:
  struct Box {
    std::unique_ptr<btBoxShape> shape;
    std::unique_ptr<btRigidBody> body;
  };

  void add_walls(const Bin& bin, const Eigen::Isometry3d& T_world_bin, BodyLabel& label, int meets);
  void add_box(const Eigen::Isometry3d& T_world_box, const Eigen::Vector3d& size_m,
               BodyLabel& label, int meets);

  simulation::BulletWorld& world_;
  BodyLabel table_{BodyLabel::Kind::kObstacle, "table"};
  BodyLabel bin_{BodyLabel::Kind::kObstacle, "bin"};
  BodyLabel place_{BodyLabel::Kind::kObstacle, "place box"};
  std::deque<Box> boxes_;
};

}  // namespace graspd::sim_cell
