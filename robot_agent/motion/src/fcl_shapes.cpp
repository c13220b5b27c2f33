#include "fcl_shapes.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <cmath>

namespace graspd::motion {
namespace {

template <class... Functions>
struct Visitor : Functions... {
  using Functions::operator()...;
};

/// A wall of a bin whose thickness nobody said.
constexpr double kThinnestWall_m = 0.001;
constexpr double kTableSide_m = 4;

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> to_fcl(const Shape& shape, double margin_m) {
  using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
  const auto grown = [&](double size_m) { return std::max(size_m + 2 * margin_m, 1e-6); };
  return std::visit(Visitor{[&](const Box& box) -> Geometry {
                              return std::make_shared<fcl::Boxd>(box.size_m.unaryExpr(grown));
                            },
                            [&](const Cylinder& cylinder) -> Geometry {
                              return std::make_shared<fcl::Cylinderd>(
                                  grown(2 * cylinder.radius_m) / 2, grown(cylinder.length_m));
                            },
                            [&](const Sphere& sphere) -> Geometry {
                              return std::make_shared<fcl::Sphered>(grown(2 * sphere.radius_m) / 2);
                            }},
                    shape);
}

bool is_near(const Shape& shape, const Eigen::Vector3d& p_shape_m, double margin_m) {
  return std::visit(
      Visitor{[&](const Box& box) {
                return (p_shape_m.cwiseAbs() - box.size_m / 2).maxCoeff() < margin_m;
              },
              [&](const Cylinder& cylinder) {
                return p_shape_m.head<2>().norm() < cylinder.radius_m + margin_m &&
                       std::abs(p_shape_m.z()) < cylinder.length_m / 2 + margin_m;
              },
              [&](const Sphere& sphere) { return p_shape_m.norm() < sphere.radius_m + margin_m; }},
      shape);
}

std::vector<Obstacle> bin_obstacles(const Bin& bin, std::string_view owner) {
  const double wall_m = std::max(bin.wall_thickness_m, kThinnestWall_m);
  const Eigen::Vector3d inner_m = bin.inner_size_m;
  const double height_m = inner_m.z() + wall_m;  // from the floor's underside
  std::vector<Obstacle> obstacles;
  const auto add = [&](const char* name, const Eigen::Vector3d& size_m,
                       const Eigen::Vector3d& centre_m) {
    obstacles.push_back(
        {fmt::format("{} {}", owner, name),
         std::make_unique<FclObject>(to_fcl(Box{size_m}, 0),
                                     bin.T_base_bin * Eigen::Translation3d(centre_m))});
  };
  add("floor", {inner_m.x() + 2 * wall_m, inner_m.y() + 2 * wall_m, wall_m}, {0, 0, -wall_m / 2});
  for (const double side : {-1.0, 1.0}) {
    add("wall", {wall_m, inner_m.y() + 2 * wall_m, height_m},
        {side * (inner_m.x() + wall_m) / 2, 0, height_m / 2 - wall_m});
    add("wall", {inner_m.x() + 2 * wall_m, wall_m, height_m},
        {0, side * (inner_m.y() + wall_m) / 2, height_m / 2 - wall_m});
  }
  return obstacles;
}

Obstacle table_obstacle(double z_m) {
  const Box slab{Eigen::Vector3d::Constant(kTableSide_m)};
  const Eigen::Isometry3d T(Eigen::Translation3d(0, 0, z_m - kTableSide_m / 2));
  return {"the table", std::make_unique<FclObject>(to_fcl(slab, 0), T)};
}

}  // namespace graspd::motion
