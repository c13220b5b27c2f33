#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "graspd/motion/arm_model.hpp"
#include "graspd/sim_cell/pick_trace.hpp"
#include "graspd/simulation/kinect_v2.hpp"
#include "graspd/simulation/picture.hpp"
#include "graspd/simulation/pile.hpp"
#include "graspd/types/request.hpp"

namespace graspd::sim_cell {

/// How strong and how fast jaws are.
struct GripperDrive {
  double force_n = 20;        ///< of each jaw
  double speed_m_s = 0.05;    ///< of each jaw
  double pad_friction = 0.6;  ///< between a jaw and a part
};

/// Where the robot is: the gripper, and each link of the arm that carries it.
struct RobotPose {
  Eigen::Isometry3d T_base_grasp = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> T_base_links;
};

/// A cell: a bin of parts on a table, a box to put them into, an overhead Kinect v2, a gripper.
struct PhysicsCellOptions {
  Bin bin;    ///< its floor is the table's top
  Bin place;  ///< the same table's, or a raised box
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  simulation::KinectV2Parameters sensor;
  double gloss = 0;  ///< of the parts; see SceneObject
  Gripper gripper;
  GripperDrive drive;
  std::vector<motion::LinkShape> links;  ///< of the arm; none: the gripper floats
  RobotPose start;
  simulation::PileOptions parts;  ///< density, friction and restitution as the pile was made with
  std::uint64_t seed = 1;         ///< of the sensor's noise
  double settle_within_s = 4;     ///< before a frame; what still creeps then is let stand
};

/// Where a part of the cell truly is.
struct CellPart {
  std::size_t kind = 0;
  Eigen::Isometry3d T_base_part = Eigen::Isometry3d::Identity();
  bool is_placed = false;  ///< it was put into the place box, and taken away from there
  bool is_lost = false;    ///< it fell beside bin and place box, and was taken away from there
};

/// From where a picture of the cell is taken.
struct PictureView {
  CameraIntrinsics camera{480, 360, 430, 430, 239.5, 179.5, {}};
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  std::vector<simulation::Rgb> kind_colors;  ///< one for each kind of part
};

/// The cell in physics. Time passes only in its calls, and what happens is settled by the piles and
/// the calls: the same ones give the same bits on the same machine. A robot's bodies are where they
/// are told to be, whatever is in the way; only the jaws, once they close, give way to a force.
/// Belongs to one thread.
class PhysicsCell {
 public:
  /// \param kinds the meshes, which must outlive the cell. \param pile at rest, in the bin's frame
  PhysicsCell(const std::vector<parts::Mesh>& kinds, const simulation::Pile& pile,
              const PhysicsCellOptions& options);
  ~PhysicsCell();
  PhysicsCell(const PhysicsCell&) = delete;
  PhysicsCell& operator=(const PhysicsCell&) = delete;

  const PhysicsCellOptions& options() const;
  double time_s() const;

  /// Moves the robot for so long. \param robot_at by the time since the motion began
  /// \returns INTERNAL where it met more resistance than an arm would push on against: it stands
  /// where that was.
  Result<void> follow(double duration_s, const std::function<RobotPose(double)>& robot_at);
  /// How many motions ended so.
  int stalls_n() const;
  /// Returns when the jaws are there, at the drive's speed; kept within the gripper's stroke. What
  /// they held is let go.
  void open(double opening_m);
  /// Until the jaws stand.
  void close();
  void wait(double duration_s);
  /// Where the gripper is now.
  Eigen::Isometry3d T_base_grasp() const;
  double opening_m() const;
  /// Whether the jaws were stopped by something between them.
  bool holds_something() const;

  /// What the camera sees, with the robot out of view. First what still moves comes to rest; and
  /// where the robot has worked since the last frame, the trace ends and another begins, and what
  /// lies in the place box, or beside it and the bin, is taken away.
  DepthFrame frame();

  /// Everything there is: bin, place box, parts, gripper and arm.
  simulation::Picture picture(const PictureView& view) const;
  /// Whenever so much time has passed, in whatever call: for pictures. \param watch must not move
  /// anything; an empty one ends it
  void every(double period_s, std::function<void()> watch);

  /// In the pile's order, those that were taken away included.
  std::vector<CellPart> parts() const;
  /// The part whose barycentre is nearest to where a part of this kind is said to be, within half
  /// its diameter. As of the last frame.
  std::optional<std::size_t> part_at(std::size_t kind, const Eigen::Isometry3d& T_base_part) const;
  /// Of the time between the last two frames.
  const PickTrace& last_trace() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::sim_cell
