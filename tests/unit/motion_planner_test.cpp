#include "graspd/motion/motion_planner.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "graspd/motion/collision_world.hpp"
#include "motion_cell.hpp"

namespace graspd::motion {
namespace {

using graspd::testing::MotionCell;
using graspd::testing::turn_between;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Planner : public ::testing::Test {
 protected:
  Result<std::vector<agent::JointTrajectory>> plan(std::span<const agent::Motion> motions) {
    auto planner = MotionPlanner::create(cell.arm, cell.parameters).value();
    planner.set_surroundings(cell.around, cell.out_of_view_rad);
    return planner.plan(motions, cell.out_of_view_rad);
  }
  std::string why_not(std::span<const agent::Motion> motions) {
    const auto trajectories = plan(motions);
    return trajectories ? "" : trajectories.error().message;
  }

  MotionCell cell;
};

/// Whether the arm, following linearly, touches nothing on the way. Corners are rounded, so the
/// margin is left to them.
void expect_free(const MotionCell& cell, const agent::JointTrajectory& trajectory,
                 Posture posture) {
  MotionParameters without_margin = cell.parameters;
  without_margin.margin_m = 0;
  CollisionWorld world(cell.arm, without_margin);
  world.set_surroundings(cell.around, cell.out_of_view_rad);
  for (const agent::JointPoint& point : trajectory) {
    const auto touched = world.touch(point.q_rad, posture);
    ASSERT_FALSE(touched) << *touched << " at " << point.t_s << " s";
  }
}

TEST_F(Planner, SixMotionsOfAPickFollowEachOtherToTheirPosesTouchingNothing) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> side(-0.06, 0.06);
  std::uniform_real_distribution<double> yaw(-3.1, 3.1);
  std::uniform_real_distribution<double> height(0.015, 0.06);
  int planned_n = 0;
  for (int i = 0; i < 100; ++i) {
    const auto T = MotionCell::down(0.30 + side(random), side(random), height(random), yaw(random));
    const auto motions = cell.pick_at(T).all();
    const auto trajectories = plan(motions);
    if (!trajectories) {
      EXPECT_THAT(trajectories.error().message, HasSubstr("bin's wall"));
      continue;
    }
    ++planned_n;
    ASSERT_EQ(trajectories->size(), motions.size());
    agent::Joints at_rad = cell.out_of_view_rad;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const agent::JointTrajectory& trajectory = (*trajectories)[k];
      EXPECT_EQ(trajectory.front().q_rad, at_rad);
      at_rad = trajectory.back().q_rad;
      const Eigen::Isometry3d T_reached = cell.T_base_grasp(at_rad);
      const Eigen::Isometry3d& T_asked = motions[k].T_base_grasp;
      EXPECT_LT((T_reached.translation() - T_asked.translation()).norm(), 1e-6);
      EXPECT_LT((T_reached.linear().col(2) - T_asked.linear().col(2)).norm(), 1e-6);
      EXPECT_GT(std::abs(T_reached.linear().col(0).dot(T_asked.linear().col(0))), 1 - 1e-9);
      expect_free(cell, trajectory, {motions[k].opening_width_m, false, true});
    }
  }
  EXPECT_GT(planned_n, 60);
}

TEST_F(Planner, TheSameQuestionHasTheSameAnswer) {
  const auto motions = cell.pick_at(MotionCell::down(0.31, 0.02, 0.03)).all();
  auto planner = MotionPlanner::create(cell.arm, cell.parameters).value();
  planner.set_surroundings(cell.around, cell.out_of_view_rad);
  const auto first = planner.plan(motions, cell.out_of_view_rad);
  ASSERT_TRUE(first) << first.error().message;
  const auto others = cell.pick_at(MotionCell::down(0.28, -0.03, 0.03)).all();
  static_cast<void>(planner.plan(others, cell.out_of_view_rad));
  const auto again = planner.plan(motions, cell.out_of_view_rad);
  ASSERT_TRUE(again);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    ASSERT_EQ((*first)[k].size(), (*again)[k].size());
    for (std::size_t i = 0; i < (*first)[k].size(); ++i) {
      EXPECT_EQ((*first)[k][i].q_rad, (*again)[k][i].q_rad);
    }
  }
}

TEST_F(Planner, RisesOutOfTheBinWhereTheDirectWayMeetsItsWall) {
  Grasp grasp = cell.grasp_at(MotionCell::down(0.31, 0.02, 0.02));
  grasp.retreat_m = 0.02;  // the tips are still 65 mm below the rim
  const auto motions = agent::pick_motions(grasp, cell.T_base_place).all();
  const auto trajectories = plan(motions);
  ASSERT_TRUE(trajectories) << trajectories.error().message;
  const agent::JointTrajectory& transfer = (*trajectories)[3];
  expect_free(cell, transfer, {grasp.opening_width_m, true, true});
  double highest_m = 0;
  for (const agent::JointPoint& point : transfer) {
    highest_m = std::max(highest_m, cell.T_base_grasp(point.q_rad).translation().z());
  }
  EXPECT_GT(highest_m, 0.105);
}

class PlannerAtAPost : public Planner {
 protected:
  PlannerAtAPost() { from_rad[0] = 0; }

  /// Readings of something high, from this far from the base outwards.
  void add_post(double yaw_rad, int from_cm) {
    for (int r_cm = from_cm; r_cm < 45; ++r_cm) {
      const double r_m = 0.01 * r_cm;
      const Eigen::Vector3d p_m(r_m * std::cos(yaw_rad), r_m * std::sin(yaw_rad), 0.9);
      cell.around.p_base_m.push_back(p_m.cast<float>());
    }
  }
  Result<agent::JointTrajectory> plan_out_of_view() {
    auto planner = MotionPlanner::create(cell.arm, cell.parameters).value();
    planner.set_surroundings(cell.around, cell.out_of_view_rad);
    return planner.plan_to(cell.out_of_view_rad, from_rad);
  }

  agent::Joints from_rad = cell.out_of_view_rad;
};

TEST_F(PlannerAtAPost, FindsAWayAroundByTheSameSearchEachTime) {
  add_post(-0.85, 22);
  const auto trajectory = plan_out_of_view();
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  EXPECT_EQ(trajectory->front().q_rad, from_rad);
  EXPECT_EQ(trajectory->back().q_rad, cell.out_of_view_rad);
  expect_free(cell, *trajectory, {cell.parameters.gripper.max_opening_m});
  const auto again = plan_out_of_view();
  ASSERT_TRUE(again);
  ASSERT_EQ(trajectory->size(), again->size());
  for (std::size_t i = 0; i < again->size(); ++i) {
    EXPECT_EQ((*trajectory)[i].q_rad, (*again)[i].q_rad);
  }
  cell.parameters.max_tries_n = 0;
  const auto without_search = plan_out_of_view();
  ASSERT_FALSE(without_search);
  EXPECT_EQ(without_search.error().message, "no way around was found in 0 tries");
}

TEST_F(Planner, OutOfReachIsSaidOfTheFirstMotionThatIs) {
  EXPECT_THAT(why_not(cell.pick_at(MotionCell::down(0.8, 0, 0.03)).all()),
              StartsWith("pre_grasp: out of reach: the wrist would be 0."));
  cell.T_base_place = MotionCell::down(0.0, 0.9, 0.1);
  EXPECT_THAT(why_not(cell.pick_at(MotionCell::down(0.31, 0, 0.03)).all()),
              StartsWith("transfer: out of reach: the wrist would be 0."));
}

TEST_F(Planner, WhatIsInTheWayOfTheGraspIsSaid) {
  EXPECT_THAT(
      why_not(cell.pick_at(MotionCell::down(0.31, 0, -0.01)).all()),
      ::testing::ContainsRegex("approach: a jaw would touch the bin's floor, after [0-9]+ mm"));
  EXPECT_THAT(why_not(cell.pick_at(MotionCell::down(0.31, 0.13, 0.03)).all()),
              HasSubstr("would touch the bin's wall"));
}

TEST_F(Planner, BeyondItsLimitsTheArmDoesNotMove) {
  cell.out_of_view_rad[2] = 4.1;
  EXPECT_EQ(why_not(cell.pick_at(MotionCell::down(0.31, 0, 0.03)).all()),
            "the arm stands beyond its limits: joint_3 would be at 4.100 rad (limits -0.698 to "
            "3.840): move it back by hand");
}

TEST_F(Planner, TurnsTheGripperOnlyWhereItMay) {
  cell.parameters.allow_turned_gripper = false;
  int planned_n = 0;
  for (const double yaw_rad : {0.0, 1.0, 2.0, 3.0, -1.0, -2.0}) {
    const auto motions = cell.pick_at(MotionCell::down(0.30, 0, 0.04, yaw_rad)).all();
    const auto trajectories = plan(motions);
    if (!trajectories) continue;
    ++planned_n;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      EXPECT_LT(
          turn_between(cell.T_base_grasp((*trajectories)[k].back().q_rad), motions[k].T_base_grasp),
          1e-5);
    }
  }
  EXPECT_GE(planned_n, 4);
}

TEST_F(Planner, ASlowerMotionTakesLongerOnTheSameWay) {
  std::vector<agent::Motion> motions{cell.pick_at(MotionCell::down(0.31, 0, 0.03)).pre_grasp};
  const double duration_s = plan(motions).value().front().back().t_s;
  motions.front().speed_share = 0.5;
  const auto slow = plan(motions).value();
  EXPECT_GT(slow.front().back().t_s, 1.5 * duration_s);
  EXPECT_LT(slow.front().back().t_s, 2 * duration_s + 1e-9);
}

TEST_F(Planner, AnyArmByKdl) {
  cell.parameters.ik = IkKind::kKdl;
  const auto motions = cell.pick_at(MotionCell::down(0.31, 0, 0.03)).all();
  const auto trajectories = plan(motions);
  ASSERT_TRUE(trajectories) << trajectories.error().message;
  const Eigen::Isometry3d T = cell.T_base_grasp((*trajectories)[1].back().q_rad);
  EXPECT_LT((T.translation() - motions[1].T_base_grasp.translation()).norm(), 1e-5);
}

TEST_F(Planner, WrongParametersAreRefused) {
  cell.parameters.straight_step_m = 0;
  EXPECT_FALSE(MotionPlanner::create(cell.arm, cell.parameters));
  cell.parameters = MotionCell::mounted();
  cell.parameters.margin_m = -0.001;
  const auto planner = MotionPlanner::create(cell.arm, cell.parameters);
  ASSERT_FALSE(planner);
  EXPECT_THAT(planner.error().message, HasSubstr("margin_m"));
}

}  // namespace
}  // namespace graspd::motion
