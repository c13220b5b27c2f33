#include "obstacles.hpp"

namespace graspd::sim_cell {
namespace {

const Eigen::Vector3d kTable_m(4, 4, 0.05);
constexpr double kPlaceFloor_m = 0.02;

}  // namespace

Obstacles::Obstacles(simulation::BulletWorld& world, const Bin& bin, const Bin& place)
    : world_(world) {
  add_box(Eigen::Isometry3d(Eigen::Translation3d(0, 0, -kTable_m.z() / 2)), kTable_m, table_,
          kRobot);
  add_walls(bin, Eigen::Isometry3d::Identity(), bin_, kRobot);
  const Eigen::Isometry3d T_bin_place = bin.T_base_bin.inverse() * place.T_base_bin;
  add_walls(place, T_bin_place, place_, kRobot | kMovingParts);
  const Eigen::Vector3d floor_m(place.inner_size_m.x(), place.inner_size_m.y(), kPlaceFloor_m);
  add_box(T_bin_place * Eigen::Translation3d(0, 0, -kPlaceFloor_m / 2), floor_m, place_,
          kRobot | kMovingParts);
}

Obstacles::~Obstacles() {
  for (const Box& box : boxes_) world_.bullet().removeRigidBody(box.body.get());
}

void Obstacles::add_walls(const Bin& bin, const Eigen::Isometry3d& T_world_bin, BodyLabel& label,
                          int meets) {
  const Eigen::Vector3d& size = bin.inner_size_m;
  const double wall_m = bin.wall_thickness_m;
  const auto wall = [&](double x_m, double y_m, const Eigen::Vector3d& size_m) {
    add_box(T_world_bin * Eigen::Translation3d(x_m, y_m, size.z() / 2), size_m, label, meets);
  };
  for (const int side : {-1, 1}) {
    wall(side * (size.x() + wall_m) / 2, 0, {wall_m, size.y() + 2 * wall_m, size.z()});
    wall(0, side * (size.y() + wall_m) / 2, {size.x(), wall_m, size.z()});
  }
}

void Obstacles::add_box(const Eigen::Isometry3d& T_world_box, const Eigen::Vector3d& size_m,
                        BodyLabel& label, int meets) {
  Box& box = boxes_.emplace_back();
  box.shape = std::make_unique<btBoxShape>(simulation::to_bullet(Eigen::Vector3d(size_m / 2)));
  box.body = world_.make_body(box.shape.get(), 0);
  box.body->setWorldTransform(simulation::to_bullet(T_world_box));
  box.body->setUserPointer(&label);
  world_.bullet().addRigidBody(box.body.get(), kObstacles, meets);
}

}  // namespace graspd::sim_cell
