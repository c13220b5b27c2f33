#include "graspd/motion/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The path is a quadratic B-spline over its points: between s = i - 1/2 and s = i + 1/2 its
/// velocity q' goes from the step before point i to the step after it, and q'' is their difference.
/// With x = (ds/dt)², constant acceleration u over such a cell and
///   dq/dt = q' √x,   d²q/dt² = q' u + q'' x
/// the limits are bounds of x at the cells' ends and of |u| within, and the fastest x(s) is found
/// by one pass forwards and one backwards. Half of a joint's acceleration is kept for bends (q''
/// x).
namespace graspd::motion {

void JointPath::append(const JointPath& other) {
  if (q_rad.empty()) {
    *this = other;
    return;
  }
  q_rad.insert(q_rad.end(), other.q_rad.begin() + 1, other.q_rad.end());
  tip_m.insert(tip_m.end(), other.tip_m.begin(), other.tip_m.end());
}

JointPath joint_line(const agent::Joints& from_rad, const agent::Joints& to_rad, double step_rad) {
  const double furthest_rad = (to_rad - from_rad).cwiseAbs().maxCoeff();
  // At least some, so that speeding up and slowing down have a place.
  constexpr int kFewest = 8;
  const int steps_n = std::max(kFewest, static_cast<int>(std::ceil(furthest_rad / step_rad)));
  JointPath path;
  for (int i = 0; i <= steps_n; ++i) {
    path.q_rad.emplace_back(from_rad + (to_rad - from_rad) * i / steps_n);
  }
  path.q_rad.back() = to_rad;
  path.tip_m.assign(static_cast<std::size_t>(steps_n), 0.0);
  return path;
}

namespace {

struct Cell {
  double length = 0;         ///< in s
  Eigen::VectorXd q_rad;     ///< where it begins
  Eigen::VectorXd velocity;  ///< q' there
  Eigen::VectorXd bend;      ///< q''
  Eigen::VectorXd fastest;   ///< |q'|, joint by joint
  double max_x = 0;
  double max_u = 0;
};

std::vector<Cell> spline(const std::vector<agent::Joints>& points_rad) {
  const std::size_t last = points_rad.size() - 1;
  std::vector<Cell> cells(points_rad.size());
  for (std::size_t i = 0; i <= last; ++i) {
    Cell& cell = cells[i];
    cell.velocity = i > 0 ? points_rad[i] - points_rad[i - 1] : points_rad[1] - points_rad[0];
    const Eigen::VectorXd after = i < last ? points_rad[i + 1] - points_rad[i] : cell.velocity;
    cell.q_rad = i > 0 ? (points_rad[i - 1] + points_rad[i]) / 2 : points_rad[0];
    cell.length = i == 0 || i == last ? 0.5 : 1;
    cell.bend = after - cell.velocity;
    cell.fastest = cell.velocity.cwiseAbs().cwiseMax(after.cwiseAbs());
  }
  return cells;
}

/// Of (ds/dt)² anywhere in each cell, and of d²s/dt² there.
void bound(std::vector<Cell>& cells, const std::vector<double>& tip_m,
           std::span<const JointLimits> limits, double max_tip_speed_m_s) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Cell& cell = cells[i];
    const double before_m = i > 0 ? tip_m[i - 1] : 0;
    const double after_m = i < tip_m.size() ? tip_m[i] : 0;
    double max_rate = std::numeric_limits<double>::max();
    if (const double step_m = std::max(before_m, after_m); step_m > 0) {
      max_rate = max_tip_speed_m_s / step_m;
    }
    for (int j = 0; j < cell.fastest.size(); ++j) {
      const JointLimits& of = limits[static_cast<std::size_t>(j)];
      const double bend = std::abs(cell.bend[j]);
      if (cell.fastest[j] > 0) {
        max_rate = std::min(max_rate, of.max_velocity_rad_s / cell.fastest[j]);
      }
      if (bend > 0) {
        max_rate = std::min(max_rate, std::sqrt(of.max_acceleration_rad_s2 / 2 / bend));
      }
    }
    cell.max_x = max_rate * max_rate;
    cell.max_u = std::numeric_limits<double>::max();
    for (int j = 0; j < cell.fastest.size(); ++j) {
      if (cell.fastest[j] == 0) continue;
      const double left = limits[static_cast<std::size_t>(j)].max_acceleration_rad_s2 -
                          std::abs(cell.bend[j]) * cell.max_x;
      cell.max_u = std::min(cell.max_u, left / cell.fastest[j]);
    }
  }
}

/// x at the cells' ends, one more than cells.
std::vector<double> fastest_profile(const std::vector<Cell>& cells) {
  std::vector<double> x(cells.size() + 1, 0.0);
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
    const double reached = x[i] + 2 * cells[i].max_u * cells[i].length;
    x[i + 1] = std::min({reached, cells[i].max_x, cells[i + 1].max_x});
  }
  x.back() = 0;
  for (std::size_t i = cells.size(); i-- > 0;) {
    x[i] = std::min(x[i], x[i + 1] + 2 * cells[i].max_u * cells[i].length);
  }
  return x;
}

/// Without the steps that go nowhere: they would take no time.
JointPath without_rests(const JointPath& path) {
  constexpr double kNothing_rad = 1e-12;
  JointPath moving{{path.q_rad.front()}, {}};
  for (std::size_t i = 1; i < path.q_rad.size(); ++i) {
    if ((path.q_rad[i] - moving.q_rad.back()).cwiseAbs().maxCoeff() < kNothing_rad) continue;
    moving.q_rad.push_back(path.q_rad[i]);
    moving.tip_m.push_back(path.tip_m[i - 1]);
  }
  return moving;
}

}  // namespace

agent::JointTrajectory time_parameterise(const JointPath& path, std::span<const JointLimits> limits,
                                         double max_tip_speed_m_s, double period_s) {
  const JointPath moving = without_rests(path);
  if (moving.q_rad.size() < 2) {
    return {{0, path.q_rad.front()}, {period_s, path.q_rad.back()}};
  }
  std::vector<Cell> cells = spline(moving.q_rad);
  bound(cells, moving.tip_m, limits, max_tip_speed_m_s);
  const std::vector<double> x = fastest_profile(cells);

  std::vector<double> begins_s{0};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double rates = std::sqrt(x[i]) + std::sqrt(x[i + 1]);
    begins_s.push_back(begins_s.back() + 2 * cells[i].length / rates);
  }
  const double duration_s = begins_s.back();
  const int points_n = std::max(1, static_cast<int>(std::ceil(duration_s / period_s)));
  agent::JointTrajectory trajectory{{0, moving.q_rad.front()}};
  std::size_t i = 0;
  for (int k = 1; k < points_n; ++k) {
    const double t_s = duration_s * k / points_n;
    while (i + 1 < cells.size() && begins_s[i + 1] <= t_s) ++i;
    const Cell& cell = cells[i];
    const double since_s = t_s - begins_s[i];
    const double u = (x[i + 1] - x[i]) / (2 * cell.length);
    const double s = std::sqrt(x[i]) * since_s + u * since_s * since_s / 2;
    trajectory.push_back({t_s, cell.q_rad + cell.velocity * s + cell.bend * (s * s / 2)});
  }
  trajectory.push_back({duration_s, moving.q_rad.back()});
  return trajectory;
}

}  // namespace graspd::motion
