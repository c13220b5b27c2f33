#pragma once

#include <fcl/geometry/collision_geometry.h>
#include <fcl/narrowphase/collision_object.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/agent/ports.hpp"
#include "graspd/motion/motion_parameters.hpp"

namespace graspd::motion {

using FclObject = fcl::CollisionObjectd;

/// Grown by `margin_m` on all sides, or shrunk where it is negative.
std::shared_ptr<fcl::CollisionGeometryd> to_fcl(const Shape& shape, double margin_m);

/// Whether a point in the shape's frame is in it, or nearer than `margin_m`.
bool is_near(const Shape& shape, const Eigen::Vector3d& p_shape_m, double margin_m);

/// A thing that stands in the way.
struct Obstacle {
  std::string name;
  std::unique_ptr<FclObject> object;
};

/// Floor and walls. \param owner "the bin's"
std::vector<Obstacle> bin_obstacles(const Bin& bin, std::string_view owner);
/// A slab whose top is at this height in base.
Obstacle table_obstacle(double z_m);

}  // namespace graspd::motion
