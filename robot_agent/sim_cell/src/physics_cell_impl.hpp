#pragma once

#include <optional>
#include <vector>

#include "graspd/sim_cell/physics_cell.hpp"
#include "gripper_bodies.hpp"
#include "link_bodies.hpp"
#include "obstacles.hpp"
#include "part_bodies.hpp"
#include "trace_recorder.hpp"

namespace graspd::sim_cell {

/// The world's frame is the bin's.
struct PhysicsCell::Impl {
  Impl(const std::vector<parts::Mesh>& meshes, const simulation::Pile& pile,
       const PhysicsCellOptions& given);

  /// One step in which the gripper moves to a pose. \returns the worst resistance to it
  Resistance step(double step_s, const Eigen::Isometry3d& T_bin_grasp, double opening_m);
  void stand(double duration_s);
  int steps_in(double duration_s) const;
  double step_s() const;
  /// What waited while the gripper was at work moves now, in the time that has passed since.
  void settle();
  /// Ends the trace and begins another, and takes away what lies in the place box, or in none.
  void take_stock();
  /// Not those that the robot still touches.
  std::vector<std::size_t> parts_in_place_box() const;
  std::vector<std::size_t> parts_on_table() const;
  DepthFrame observe_cell();

  const std::vector<parts::Mesh>& kinds;
  PhysicsCellOptions options;
  Eigen::Isometry3d T_base_bin, T_bin_base;
  std::vector<simulation::PartShape> shapes;
  simulation::BulletWorld world;
  Obstacles obstacles;
  PartBodies parts;
  GripperBodies gripper;
  LinkBodies links;
  TraceRecorder recorder;
  parts::Mesh bin;

  double time_s = 0;
  std::uint64_t frames_n = 0;
  std::optional<simulation::StillScene> seen;  ///< by the last frame
  std::vector<simulation::SceneObject> scene_seen;
  bool has_worked = true;  ///< the robot, since the last frame
  PickTrace last_trace;
  std::vector<std::size_t> lost;  ///< parts that fell beside bin and place box
  std::vector<Eigen::Isometry3d> T_base_parts_at_frame;
  std::function<void()> watch;
  double watch_every_s = 0, watch_next_s = 0;
  bool is_settling = false;
  std::optional<double> paused_at_s;  ///< since then parts wait to move on
  bool is_stalled = false;
  int stalls_n = 0;
  bool has_closed = false;  ///< the jaws are closed, on something or on nothing
};

}  // namespace graspd::sim_cell
