#include "cell_robot.hpp"

#include "graspd/motion/inverse_kinematics.hpp"
#include "graspd/sim_cell/scene.hpp"

namespace graspd::bench {
namespace {

constexpr double kCameraHeight_m = 0.75;
const Eigen::Vector3d kPlace_m(0, -0.31, 0);

Eigen::Isometry3d pointing_down(const Eigen::Vector3d& p_m) {
  return Eigen::Translation3d(p_m) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
}

/// Above the place box.
const Eigen::Isometry3d kOutOfView = pointing_down(kPlace_m + Eigen::Vector3d(0, 0, 0.20));

Result<agent::Joints> joints_at(const Eigen::Isometry3d& T_base_grasp, const motion::ArmModel& arm,
                                const motion::MotionParameters& parameters) {
  auto ik = motion::make_inverse_kinematics(parameters.ik, arm);
  if (!ik) return tl::unexpected(ik.error());
  auto found = (*ik)->solve(T_base_grasp * parameters.T_flange_grasp.inverse(),
                            agent::Joints::Zero(arm.joints_n()));
  if (!found) return tl::unexpected(found.error());
  return found->front();
}

}  // namespace

sim_cell::PhysicsCellOptions layout(int seed) {
  sim_cell::PhysicsCellOptions cell;
  cell.bin.inner_size_m = {0.30, 0.24, 0.12};
  cell.bin.wall_thickness_m = 0.005;
  cell.bin.T_base_bin =
      Eigen::Translation3d(0.30, 0, 0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  cell.place.inner_size_m = {0.20, 0.20, 0.04};
  cell.place.wall_thickness_m = 0.005;
  cell.place.T_base_bin.translation() = kPlace_m;
  cell.T_base_camera = cell.bin.T_base_bin * sim_cell::camera_over_bin(kCameraHeight_m, 0);
  // Fingers long enough to reach the floor along a wall while the palm stays above the rim.
  cell.gripper.jaw_size_m = {0.008, 0.016, 0.12};
  cell.gripper.palm_size_m = {0.10, 0.06, 0.05};
  // What hangs below the tips clears the rim before it is carried away.
  cell.gripper.retreat_m = 0.16;
  cell.seed = static_cast<std::uint64_t>(seed) << 16;
  return cell;
}

Eigen::Isometry3d place_pose(const sim_cell::PhysicsCellOptions& cell) {
  return pointing_down(cell.place.T_base_bin * Eigen::Vector3d(0, 0, 0.07));
}

Result<CellRobot> make_robot(const std::vector<parts::Mesh>& kinds, const sim_cell::Pile& pile,
                             const sim_cell::PhysicsCellOptions& options,
                             const std::optional<motion::ArmModel>& arm) {
  CellRobot robot;
  if (!arm) {
    sim_cell::PhysicsCellOptions floating = options;
    floating.start.T_base_grasp = kOutOfView;
    robot.cell =
        std::make_unique<agent::SimCell>(kinds, pile, floating, std::nullopt,
                                         agent::FloatingOptions{.T_base_out_of_view = kOutOfView});
    return robot;
  }
  motion::MotionParameters parameters;
  parameters.gripper = options.gripper;
  parameters.place_bin = options.place;
  parameters.table_z_m = 0;
  // The flange's z points into the arm.
  const double length_m = options.gripper.jaw_size_m.z() + options.gripper.palm_size_m.z();
  parameters.T_flange_grasp = pointing_down({0, 0, -length_m});
  const auto out_of_view_rad = joints_at(kOutOfView, *arm, parameters);
  if (!out_of_view_rad) return tl::unexpected(out_of_view_rad.error());
  robot.cell = std::make_unique<agent::SimCell>(
      kinds, pile, options, agent::SimArm{*arm, parameters.T_flange_grasp, *out_of_view_rad},
      agent::FloatingOptions{});
  auto planned =
      motion::PlannedArm::create(robot.cell->joint_driver(), *arm, parameters, *out_of_view_rad);
  if (!planned) return tl::unexpected(planned.error());
  robot.planned = *std::move(planned);
  return robot;
}

}  // namespace graspd::bench
