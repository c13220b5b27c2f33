#pragma once

#include "graspd/agent/ports.hpp"
#include "graspd/simulated/sim_cell.hpp"

namespace graspd::agent {

/// A gripper that no arm carries: it gets anywhere, free motions by way of a safe height.
class FloatingArm final : public Arm {
 public:
  FloatingArm(sim_cell::PhysicsCell& cell, const FloatingOptions& options)
      : cell_(cell), options_(options) {}

  void set_surroundings(const Surroundings& surroundings) override;
  std::optional<std::string> why_not(std::span<const Motion> motions) override;
  Result<void> move(const Motion& motion) override;
  Result<void> move_out_of_view() override;
  Result<void> stop() override;

 private:
  Result<void> move_free(const Eigen::Isometry3d& T_base_grasp, double speed_share);
  Result<void> move_straight(const Eigen::Isometry3d& T_base_grasp, double speed_m_s,
                             double speed_share);

  sim_cell::PhysicsCell& cell_;
  FloatingOptions options_;
};

}  // namespace graspd::agent
