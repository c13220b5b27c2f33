#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "graspd/sim_cell/physics_cell.hpp"
#include "sim_meshes.hpp"

/// A physics cell whose parts lie where the test puts them, and a pick in the way of the agent's.
namespace graspd::testing {

inline sim_cell::PhysicsCellOptions scripted_options() {
  sim_cell::PhysicsCellOptions options;
  options.bin.inner_size_m = {0.30, 0.24, 0.08};
  options.bin.wall_thickness_m = 0.005;
  options.place = options.bin;
  options.place.T_base_bin.translation().x() = 0.4;
  options.T_base_camera =
      Eigen::Translation3d(0, 0, 0.75) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  options.start.T_base_grasp =
      Eigen::Translation3d(0.4, 0, 0.35) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  return options;
}

inline Eigen::Isometry3d at(double x_m, double y_m, double z_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, y_m, z_m));
}

/// The gripper points down and closes along x.
inline Eigen::Isometry3d down_at(double x_m, double y_m, double z_m) {
  return at(x_m, y_m, z_m) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
}

class ScriptedCell {
 public:
  ScriptedCell(std::vector<parts::Mesh> kinds, std::vector<simulation::PiledPart> parts,
               const sim_cell::PhysicsCellOptions& options = scripted_options())
      : kinds_(std::move(kinds)) {
    simulation::Pile pile;
    pile.parts = std::move(parts);
    cell = std::make_unique<sim_cell::PhysicsCell>(kinds_, pile, options);
  }

  Result<void> move(const Eigen::Isometry3d& to, double speed_m_s = 0.2) {
    const Eigen::Isometry3d from = cell->T_base_grasp();
    const Eigen::Quaterniond q_from(from.linear()), q_to(to.linear());
    const double length_m = (to.translation() - from.translation()).norm();
    const double duration_s = std::max(0.1, length_m / speed_m_s);
    return cell->follow(duration_s, [&](double t_s) {
      const double u = t_s / duration_s, s = u * u * (3 - 2 * u);
      const Eigen::Vector3d p = from.translation() + s * (to.translation() - from.translation());
      return sim_cell::RobotPose{Eigen::Translation3d(p) * q_from.slerp(s, q_to), {}};
    });
  }

  /// As the agent does it: pre-grasp, open, approach, close, lift, transfer, place, release,
  /// retreat, and the next frame. After a resistance the arm stands still.
  void pick(const Eigen::Isometry3d& T_base_grasp, double opening_m,
            const Eigen::Isometry3d& T_base_place = down_at(0.4, 0, 0.06)) {
    const Eigen::Isometry3d up = at(0, 0, 0.12);
    const auto go = [this](const Eigen::Isometry3d& to) {
      if (!is_stopped) is_stopped = !move(to);
    };
    cell->frame();
    go(up * T_base_grasp);
    cell->open(opening_m);
    go(T_base_grasp);
    if (!is_stopped) cell->close();
    go(up * T_base_grasp);
    go(up * T_base_place);
    go(T_base_place);
    cell->open(opening_m);
    go(up * T_base_place);
    cell->frame();
  }

  sim_cell::JudgedPick judged(std::optional<std::size_t> intended) const {
    return sim_cell::judge(cell->last_trace(), intended);
  }

  std::unique_ptr<sim_cell::PhysicsCell> cell;
  bool is_stopped = false;

 private:
  std::vector<parts::Mesh> kinds_;
};

}  // namespace graspd::testing
