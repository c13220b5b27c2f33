#pragma once

#include <Eigen/Core>
#include <vector>

namespace graspd::bench {

/// Of the line with least squares in y; 0 where all points have the same x.
inline double slope(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  double products = 0;
  double squares = 0;
  for (const Eigen::Vector2d& p : points) {
    products += (p.x() - mean.x()) * (p.y() - mean.y());
    squares += (p.x() - mean.x()) * (p.x() - mean.x());
  }
  return squares > 0 ? products / squares : 0;
}

}  // namespace graspd::bench
