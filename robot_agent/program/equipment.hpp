#pragma once

#include <functional>
#include <memory>

#include "cell_config.hpp"
#include "cell_frames.hpp"

namespace graspd::robot_agent {

/// The outside things of one cell. Shared, since one thing may be several of them: a simulated cell
/// all four, a recording arm also a gripper.
struct Equipment {
  std::shared_ptr<agent::Clock> clock;
  std::shared_ptr<agent::Camera> camera;
  std::shared_ptr<agent::Arm> arm;
  std::shared_ptr<agent::Gripper> gripper;
  /// The same planner, whose time passes on that clock as well.
  std::function<agent::Planner&(agent::Planner&)> timed =
      [](agent::Planner& planner) -> agent::Planner& { return planner; };
  /// What is left to do when the cell has ended.
  std::function<Result<void>()> finish = [] { return Result<void>(); };
};

/// What the configuration names: the one place that knows every adapter.
/// \returns INVALID_ARGUMENT where a file that is named is not there, or not what it should be;
/// UNAVAILABLE where camera or arm does not answer. Nothing has moved then.
Result<Equipment> make_equipment(const CellConfig& config, const CellFrames& frames);
/// Clock and camera alone: neither a real arm nor a gripper is opened.
Result<Equipment> make_camera(const CellConfig& config, const CellFrames& frames);

}  // namespace graspd::robot_agent
