/// Grasp position, angle and width (the paper, III-D.2) with numbers worked out by hand.
#include "graspd/perception/grasp_planning.hpp"

#include <gtest/gtest.h>

#include "block_scene.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

const parts::Part& bar() {
  static const parts::Part part = testing::block_part("bar", {0.080, 0.020, 0.010});
  return part;
}

PlacedPart at(const Vector3d& p_m, double yaw_rad = 0, double pitch_rad = 0) {
  PlacedPart placed{&bar(), Eigen::Isometry3d::Identity()};
  placed.T_floor_part.translate(p_m);
  placed.T_floor_part.rotate(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(pitch_rad, Vector3d::UnitY()));
  return placed;
}

CheckState state_of(const PlannedGrasp& grasp, Check check) {
  for (const auto& report : grasp.checks) {
    if (report.check == check) return report.state;
  }
  return CheckState::kNotRun;
}

TEST(PlanGrasp, ClosesAcrossTheAxisAndComesFromAbove) {
  for (const double yaw : {0.0, 0.4, 1.3, 2.9}) {
    const std::vector<PlacedPart> parts = {at({0, 0, 0.02}, yaw)};
    const PlannedGrasp grasp = plan_grasp(0, parts, std::nullopt, Gripper{}, {});
    const Eigen::Matrix3d R = grasp.T_floor_grasp.linear();
    EXPECT_TRUE(R.col(2).isApprox(-Vector3d::UnitZ(), 1e-9)) << "approach from above";
    EXPECT_NEAR(R.col(0).dot(parts[0].principal_axis()), 0, 1e-9) << "closing across the axis";
    EXPECT_NEAR(R.determinant(), 1, 1e-9);
    // The bar's width is 20 mm; 5 mm of clearance on each side.
    EXPECT_NEAR(grasp.opening_width_m, 0.030, 1e-6);
    EXPECT_EQ(state_of(grasp, Check::kOpening), CheckState::kPassed);
    EXPECT_EQ(state_of(grasp, Check::kGripperBin), CheckState::kNotRun) << "no bin was given";
    EXPECT_TRUE(grasp.is_free());
  }
}

TEST(PlanGrasp, APartThatStandsIsGraspedAcrossItsSecondAxis) {
  const std::vector<PlacedPart> parts = {at({0, 0, 0.04}, 0, M_PI / 2)};
  const PlannedGrasp grasp = plan_grasp(0, parts, std::nullopt, Gripper{}, {});
  // Upright, the bar shows 20 mm along y and 10 mm along x: the jaws take the 10 mm.
  EXPECT_NEAR(grasp.opening_width_m, 0.020, 1e-6);
}

TEST(PlanGrasp, SaysWhenTheGripperIsTooNarrow) {
  Gripper gripper;
  gripper.max_opening_m = 0.025;
  const std::vector<PlacedPart> parts = {at({0, 0, 0.02})};
  const PlannedGrasp grasp = plan_grasp(0, parts, std::nullopt, gripper, {});
  EXPECT_FALSE(grasp.is_free());
  EXPECT_EQ(state_of(grasp, Check::kOpening), CheckState::kFailed);
  EXPECT_NEAR(grasp.opening_width_m, 0.025, 1e-9) << "clamped to the stroke";
  EXPECT_NE(grasp.checks.front().reason.find("20.0 mm wide"), std::string::npos)
      << grasp.checks.front().reason;
}

TEST(PlanGrasp, TiltsAwayFromAWall) {
  const Vector3d bin_m(0.3, 0.2, 0.1);
  // 28 mm from the wall at x = +0.15: the palm, 50 mm to each side, does not fit straight down.
  const std::vector<PlacedPart> parts = {at({0.122, 0, 0.03}, M_PI / 2)};
  const PlannedGrasp grasp = plan_grasp(0, parts, bin_m, Gripper{}, {});
  EXPECT_EQ(state_of(grasp, Check::kGripperBin), CheckState::kPassed);
  const Vector3d approach = grasp.T_floor_grasp.linear().col(2);
  EXPECT_LT(approach.z(), -0.8) << "as near to vertical as the bin allows";
  EXPECT_GT(approach.x(), 0.05) << "from the middle towards the wall";
}

TEST(PlanGrasp, InTheMiddleOfTheBinDoesNotTilt) {
  const std::vector<PlacedPart> parts = {at({0, 0, 0.03})};
  const PlannedGrasp grasp = plan_grasp(0, parts, Vector3d(0.3, 0.2, 0.1), Gripper{}, {});
  EXPECT_TRUE(grasp.T_floor_grasp.linear().col(2).isApprox(-Vector3d::UnitZ(), 1e-9));
}

TEST(GripperInsideBin, FloorAndWallsCount) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Vector3d(1, -1, -1).asDiagonal();
  T.translation() = Vector3d(0, 0, 0.01);
  const Vector3d bin_m(0.3, 0.2, 0.1);
  EXPECT_TRUE(gripper_inside_bin(T, 0.03, Gripper{}, bin_m));
  T.translation() = Vector3d(0, 0, -0.001);
  EXPECT_FALSE(gripper_inside_bin(T, 0.03, Gripper{}, bin_m)) << "tips in the floor";
  T.translation() = Vector3d(0.13, 0, 0.01);
  EXPECT_FALSE(gripper_inside_bin(T, 0.03, Gripper{}, bin_m)) << "jaw in the wall";
  T.translation() = Vector3d(0.13, 0, 0.12);
  EXPECT_TRUE(gripper_inside_bin(T, 0.03, Gripper{}, bin_m)) << "above the rim";
}

}  // namespace
}  // namespace graspd::perception
