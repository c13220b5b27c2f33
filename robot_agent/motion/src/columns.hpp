#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace graspd::motion {

/// What stands on one square of a grid over base's x and y.
struct Column {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double top_m = 0;
};

/// The highest reading over each square of this edge, of those that `counts`.
std::vector<Column> columns_of(std::span<const Eigen::Vector3f> p_base_m, double edge_m,
                               const std::function<bool(const Eigen::Vector3d&)>& counts);

}  // namespace graspd::motion
