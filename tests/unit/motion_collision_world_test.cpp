#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "graspd/motion/collision_world.hpp"
#include "motion_cell.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::MotionCell;
using graspd::testing::random_joints;
using ::testing::HasSubstr;
using ::testing::Optional;

constexpr double kNever_m = 10;

/// How deep a point is in the bin's floor and walls, or in the table below them; negative outside.
double depth_m(const Bin& bin, const Eigen::Vector3d& p_base_m) {
  const Eigen::Vector3d p = bin.T_base_bin.inverse() * p_base_m;
  const Eigen::Vector3d outer_m =
      bin.inner_size_m / 2 + Eigen::Vector3d::Constant(bin.wall_thickness_m);
  const double in_outer_m = std::min({outer_m.x() - std::abs(p.x()), outer_m.y() - std::abs(p.y()),
                                      bin.inner_size_m.z() - p.z(), p.z() + bin.wall_thickness_m});
  const double out_of_inner_m = std::max({std::abs(p.x()) - bin.inner_size_m.x() / 2,
                                          std::abs(p.y()) - bin.inner_size_m.y() / 2, -p.z()});
  const double table_m = bin.T_base_bin.translation().z() - bin.wall_thickness_m - p_base_m.z();
  return std::max(std::min(in_outer_m, out_of_inner_m), table_m);
}

/// Many of them on faces, edges and corners.
Eigen::Vector3d random_point_in(const Shape& shape, std::mt19937& random) {
  std::uniform_real_distribution<double> side(-1.5, 1.5);
  const auto draw = [&] { return std::clamp(side(random), -1.0, 1.0); };
  const double x = draw();
  const double y = draw();
  const Eigen::Vector3d at(x, y, draw());
  if (const auto* box = std::get_if<Box>(&shape)) return at.cwiseProduct(box->size_m) / 2;
  const auto& cylinder = std::get<Cylinder>(shape);
  const Eigen::Vector2d across = at.head<2>() / std::max(1.0, at.head<2>().norm());
  return {across.x() * cylinder.radius_m, across.y() * cylinder.radius_m,
          at.z() * cylinder.length_m / 2};
}

class World : public ::testing::Test {
 protected:
  std::optional<std::string> touch(const agent::Joints& q_rad, const Posture& posture = {}) {
    CollisionWorld world(cell.arm, cell.parameters);
    world.set_surroundings(cell.around, cell.out_of_view_rad);
    return world.touch(q_rad, posture);
  }

  /// Joints that bring the grasp frame there.
  agent::Joints at(const Eigen::Isometry3d& T_base_grasp) {
    const auto ik = make_inverse_kinematics(IkKind::kAnno, cell.arm).value();
    return ik
        ->solve(T_base_grasp * cell.parameters.T_flange_grasp.inverse(), agent::Joints::Zero(6))
        .value()
        .front();
  }

  MotionCell cell;
};

TEST_F(World, AgreesWithPointsDrawnFromTheLinksOnBinAndTable) {
  cell.parameters.gripper.jaw_size_m.setConstant(1e-4);
  cell.parameters.gripper.palm_size_m.setConstant(1e-4);
  cell.parameters.T_flange_grasp.setIdentity();
  CollisionWorld world(cell.arm, cell.parameters);
  world.set_surroundings(cell.around, cell.out_of_view_rad);
  std::mt19937 random(11);
  int inside_n = 0;
  int outside_n = 0;
  for (int i = 0; i < 2000; ++i) {
    const agent::Joints q_rad = random_joints(random, cell.arm);
    const auto T_base_link = cell.arm.link_poses(q_rad);
    double deepest_m = -kNever_m;
    for (std::size_t k = 0; k < T_base_link.size(); ++k) {
      const LinkShape& link = cell.arm.links()[k];
      if (link.joints_before_n < 2) continue;  // the column: always near the table, never on it
      for (const PlacedShape& placed : link.shapes) {
        for (int n = 0; n < 200; ++n) {
          const Eigen::Vector3d p_m = random_point_in(placed.shape, random);
          deepest_m = std::max(
              deepest_m, depth_m(*cell.around.bin, T_base_link[k] * placed.T_link_shape * p_m));
        }
      }
    }
    const auto touched = world.touch(q_rad, {});
    if (deepest_m > 0) {
      ++inside_n;
      EXPECT_TRUE(touched) << q_rad.transpose();
    } else if (deepest_m < -0.02) {
      ++outside_n;
      const bool by_surroundings = touched && (touched->find("bin") != touched->npos ||
                                               touched->find("table") != touched->npos);
      EXPECT_FALSE(by_surroundings) << *touched << " at " << q_rad.transpose();
    }
  }
  EXPECT_GT(inside_n, 100);
  EXPECT_GT(outside_n, 100);
}

TEST_F(World, StandsFreeOverTheBinAndSaysWhatItWouldTouch) {
  EXPECT_EQ(touch(at(MotionCell::down(0.31, 0, 0.1))), std::nullopt);
  EXPECT_THAT(touch(at(MotionCell::down(0.31, 0, 0.0))),
              Optional(HasSubstr("a jaw would touch the bin's floor")));
  EXPECT_THAT(touch(at(MotionCell::down(0.31, 0.13, 0.03))), Optional(HasSubstr("the bin's wall")));
  EXPECT_THAT(touch(at(MotionCell::down(0.05, 0.3, -0.01))), Optional(HasSubstr("the table")));
}

TEST_F(World, WhatPartsArePutIntoHasWallsToo) {
  const agent::Joints q_rad = at(MotionCell::down(0.05, 0.35, 0.05));
  EXPECT_EQ(touch(q_rad), std::nullopt);
  cell.parameters.place_bin = MotionCell::bin();
  cell.parameters.place_bin->T_base_bin.translation() = Eigen::Vector3d(0.05, 0.23, 0.005);
  EXPECT_THAT(touch(q_rad), Optional(HasSubstr("the place bin's wall")));
}

TEST_F(World, AGuidedGripperMayComeNearTheWallButNotIntoIt) {
  // Jaws 40 mm apart and 8 mm thick, closing along x; the wall's inner face is at x = 0.43. The
  // palm is small, so that it stays out of the question.
  cell.parameters.gripper.palm_size_m.x() = 0.05;
  const Posture guided{0.04, false, true};
  const Posture free{0.04, false, false};
  const agent::Joints near_rad = at(MotionCell::down(0.43 - 0.028 - 0.002, 0, 0.02));
  EXPECT_EQ(touch(near_rad, guided), std::nullopt);
  EXPECT_THAT(touch(near_rad, free), Optional(HasSubstr("the bin's wall")));
  const agent::Joints into_rad = at(MotionCell::down(0.43 - 0.028 + 0.002, 0, 0.02));
  EXPECT_THAT(touch(into_rad, guided), Optional(HasSubstr("a jaw would touch the bin's wall")));
}

TEST_F(World, TheJawsAreAsFarApartAsTheMotionSays) {
  const agent::Joints q_rad = at(MotionCell::down(0.31 + 0.08, 0, 0.09));
  cell.parameters.gripper.palm_size_m.x() = 0.05;
  EXPECT_EQ(touch(q_rad, {0.04}), std::nullopt);
  EXPECT_THAT(touch(q_rad, {0.07}), Optional(HasSubstr("a jaw would touch the bin's wall")));
}

TEST_F(World, WhatLiesUnderAReadingIsOccupied) {
  const Eigen::Isometry3d T = MotionCell::down(0.31, 0, 0.06);
  EXPECT_EQ(touch(at(T)), std::nullopt);
  cell.around.p_base_m = {{0.31F, 0.02F, 0.03F}};  // lower than the tips
  EXPECT_EQ(touch(at(T)), std::nullopt);
  cell.around.p_base_m = {{0.31F, 0.02F, 0.30F}};  // above the palm: who knows what is below
  EXPECT_THAT(touch(at(T)), Optional(HasSubstr("would touch what the camera saw")));
  // Guided, the gripper may, and the links still may not.
  EXPECT_EQ(touch(at(T), {0, false, true}).value_or("").find("the palm"), std::string::npos);
}

TEST_F(World, ReadingsOfTheArmItselfAreNotInItsWay) {
  std::mt19937 random(12);
  const auto T_base_link = cell.arm.link_poses(cell.out_of_view_rad);
  for (std::size_t k = 0; k < T_base_link.size(); ++k) {
    for (const PlacedShape& placed : cell.arm.links()[k].shapes) {
      for (int n = 0; n < 100; ++n) {
        const Eigen::Vector3d p_m = random_point_in(placed.shape, random);
        cell.around.p_base_m.push_back((T_base_link[k] * placed.T_link_shape * p_m).cast<float>());
      }
    }
  }
  EXPECT_EQ(touch(cell.out_of_view_rad), std::nullopt);
  EXPECT_EQ(touch(at(MotionCell::down(0.31, 0, 0.06))), std::nullopt);
}

TEST_F(World, ReadingsThatAreNoNumbersDoNotCount) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cell.around.p_base_m = {{nan, 0, 0}, {0.31F, 0, std::numeric_limits<float>::infinity()}};
  EXPECT_EQ(touch(at(MotionCell::down(0.31, 0, 0.06))), std::nullopt);
}

TEST_F(World, AHeldPartCountsOnlyWhileItIsHeld) {
  cell.parameters.held_radius_m = 0.05;
  const agent::Joints q_rad = at(MotionCell::down(0.31 + 0.07, 0, 0.09, 1.5708));
  EXPECT_EQ(touch(q_rad, {0, false, false}), std::nullopt);
  EXPECT_THAT(touch(q_rad, {0, true, false}),
              Optional(HasSubstr("the held part would touch the bin's wall")));
}

TEST_F(World, TheGripperDoesNotMeetItsOwnArm) {
  agent::Joints folded_rad = agent::Joints::Zero(6);
  folded_rad[1] = 0.5;
  EXPECT_EQ(touch(folded_rad), std::nullopt);
  folded_rad[4] = -0.78;  // the wrist turns the gripper under the forearm
  EXPECT_THAT(touch(folded_rad), Optional(HasSubstr("link_4")));
}

}  // namespace
}  // namespace graspd::motion
