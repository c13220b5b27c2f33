#include <gmock/gmock.h>

#include "scripted_cell.hpp"

namespace graspd::sim_cell {
namespace {

using testing::at;
using testing::box_mesh;
using ::testing::Contains;
using testing::down_at;
using ::testing::Field;
using ::testing::HasSubstr;
using testing::scripted_options;
using testing::ScriptedCell;

const Eigen::Vector3d kBox_m(0.03, 0.05, 0.04);
constexpr double kWide_m = 0.045;
constexpr double kGravity_m_s2 = 9.81;

struct Held {
  double slip_m = 0;  ///< through the jaws, in two seconds over the table
  double height_m = 0;
};

Held hold(ScriptedCell& scripted) {
  PhysicsCell& cell = *scripted.cell;
  EXPECT_TRUE(scripted.move(down_at(0, 0, 0.1)));
  cell.open(kWide_m);
  EXPECT_TRUE(scripted.move(down_at(0, 0, 0.01)));
  cell.close();
  EXPECT_TRUE(scripted.move(down_at(0, 0, 0.15)));
  const auto p_grasp_m = [&] {
    return Eigen::Vector3d(cell.T_base_grasp().inverse() *
                           cell.parts()[0].T_base_part.translation());
  };
  const Eigen::Vector3d before_m = p_grasp_m();
  cell.wait(2);
  return {(p_grasp_m() - before_m).norm(), cell.parts()[0].T_base_part.translation().z()};
}

Held hold_box(const PhysicsCellOptions& options) {
  ScriptedCell scripted({box_mesh(kBox_m)}, {{0, at(0, 0, kBox_m.z() / 2)}}, options);
  return hold(scripted);
}

/// Both jaws' friction as a share of the box's weight.
PhysicsCellOptions gripping_with(double share) {
  const simulation::PileOptions parts;
  PhysicsCellOptions options = scripted_options();
  const double weight_n = parts.density_kg_m3 * kBox_m.prod() * kGravity_m_s2;
  options.drive.force_n = share * weight_n / (2 * options.drive.pad_friction);
  return options;
}

TEST(PhysicsCellTest, AWellGrippedPartDoesNotSlip) {
  const Held held = hold_box(scripted_options());
  EXPECT_LT(held.slip_m, 0.0001);
  EXPECT_NEAR(held.height_m, 0.15 + kBox_m.z() / 2 - 0.01, 0.001);
}

TEST(PhysicsCellTest, AHollowPipeGrippedOffItsCentreDoesNotSlip) {
  Eigen::Isometry3d lying = at(0, 0.012, 0.015);
  lying.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  ScriptedCell scripted({testing::pipe_mesh(0.015, 0.012, 0.06)}, {{0, lying}});
  const Held held = hold(scripted);
  EXPECT_LT(held.slip_m, 0.0001);
  EXPECT_GT(held.height_m, 0.13);
}

TEST(PhysicsCellTest, APartIsHeldWhileTheGripperSwings) {
  ScriptedCell scripted({box_mesh(kBox_m)}, {{0, at(0, 0, kBox_m.z() / 2)}});
  hold(scripted);
  PhysicsCell& cell = *scripted.cell;
  const auto T_grasp_part = [&] {
    return cell.T_base_grasp().inverse() * cell.parts()[0].T_base_part;
  };
  const Eigen::Isometry3d before = T_grasp_part(), from = cell.T_base_grasp();
  for (const auto& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    constexpr double kSwing_rad = 0.8, kPeriod_s = 1.5;
    EXPECT_TRUE(cell.follow(kPeriod_s, [&](double t_s) {
      const double angle = kSwing_rad * std::pow(std::sin(M_PI * t_s / kPeriod_s), 2);
      return RobotPose{from * Eigen::AngleAxisd(angle, axis), {}};
    }));
    const Eigen::Isometry3d moved = before.inverse() * T_grasp_part();
    EXPECT_LT(moved.translation().norm(), 0.0005) << axis.transpose();
    EXPECT_LT(Eigen::AngleAxisd(moved.linear()).angle(), 0.02) << axis.transpose();
  }
}

TEST(PhysicsCellTest, APartFallsWhereTheJawsFrictionIsBelowItsWeight) {
  for (const double share : {1.3, 2.0}) {
    const Held held = hold_box(gripping_with(share));
    EXPECT_LT(held.slip_m, 0.0001) << share;
    EXPECT_GT(held.height_m, 0.1) << share;
  }
  for (const double share : {0.5, 0.9}) {
    EXPECT_NEAR(hold_box(gripping_with(share)).height_m, kBox_m.z() / 2, 0.001) << share;
  }
}

/// Two boxes of kBox_m: the first in the bin's middle, the second somewhere.
ScriptedCell two_boxes(const Eigen::Isometry3d& second) {
  return {{box_mesh(kBox_m)}, {{0, at(0, 0, kBox_m.z() / 2)}, {0, second}}};
}

const Eigen::Isometry3d kAside = at(-0.1, 0, kBox_m.z() / 2);

TEST(PickVerdictTest, Success) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0, 0, 0.01), kWide_m);
  const JudgedPick judged = scripted.judged(0);
  EXPECT_EQ(judged.verdict, PickVerdict::kSuccess) << judged.why;
  EXPECT_EQ(judged.others_moved_m, 0);
  EXPECT_TRUE(scripted.cell->parts()[0].is_placed);
  EXPECT_FALSE(scripted.cell->parts()[0].is_lost);
  EXPECT_FALSE(scripted.cell->parts()[1].is_placed);
}

TEST(PickVerdictTest, Missed) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0.07, 0, 0.01), kWide_m);
  EXPECT_EQ(scripted.judged(0).verdict, PickVerdict::kMissed);
  EXPECT_FALSE(scripted.cell->holds_something());
}

TEST(PickVerdictTest, WrongPart) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0, 0, 0.01), kWide_m);
  EXPECT_EQ(scripted.judged(1).verdict, PickVerdict::kWrongPart);
  EXPECT_EQ(scripted.judged(std::nullopt).verdict, PickVerdict::kWrongPart);
}

TEST(PickVerdictTest, DroppedBesideThePlaceBox) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0, 0, 0.01), kWide_m, down_at(0.4, 0.3, 0.06));
  EXPECT_EQ(scripted.judged(0).verdict, PickVerdict::kDropped);
  EXPECT_TRUE(scripted.cell->parts()[0].is_lost);
  EXPECT_FALSE(scripted.cell->parts()[0].is_placed);
  EXPECT_FALSE(scripted.cell->parts()[1].is_lost);
}

TEST(PickVerdictTest, DoubleWhereAnotherLiesOnIt) {
  const Eigen::Vector3d flat_m(0.03, 0.05, 0.02);
  ScriptedCell scripted({box_mesh(flat_m)}, {{0, at(0, 0, 0.01)}, {0, at(0, 0, 0.03)}});
  scripted.pick(down_at(0, 0, 0.003), kWide_m);
  const JudgedPick judged = scripted.judged(0);
  EXPECT_EQ(judged.verdict, PickVerdict::kDouble) << judged.why;
}

TEST(PickVerdictTest, CollisionWithAnotherPart) {
  // Under the jaw that comes down beside the first box.
  ScriptedCell scripted = two_boxes(at(0.042, 0, kBox_m.z() / 2));
  scripted.pick(down_at(0, 0, 0.01), kWide_m);
  const JudgedPick judged = scripted.judged(0);
  EXPECT_EQ(judged.verdict, PickVerdict::kCollision);
  EXPECT_THAT(judged.why, HasSubstr("jaw touched part 1"));
  ASSERT_TRUE(scripted.is_stopped);
  EXPECT_TRUE(scripted.move(down_at(0, 0, 0.2))) << "it comes free";
}

TEST(PickVerdictTest, CollisionWithTheBin) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0.13, 0, 0.01), kWide_m);
  EXPECT_THAT(scripted.judged(0).why, HasSubstr("jaw touched bin"));
  EXPECT_EQ(scripted.judged(0).verdict, PickVerdict::kCollision);
}

TEST(PickVerdictTest, CollisionWithTheTable) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0.07, 0, -0.001), kWide_m);
  EXPECT_THAT(scripted.judged(0).why, HasSubstr("jaw touched table"));
}

TEST(PhysicsCellTest, AStopIsLaidToWhatStoppedTheArm) {
  // A jaw pushes the box along while it runs into the table.
  ScriptedCell scripted = two_boxes(kAside);
  PhysicsCell& cell = *scripted.cell;
  EXPECT_TRUE(scripted.move(down_at(0.07, 0, 0.1)));
  cell.open(0.02);
  EXPECT_TRUE(scripted.move(down_at(0.07, 0, 0.01)));
  const auto stopped = scripted.move(down_at(0.025, 0, -0.003));
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, HasSubstr("jaw against table"));
  cell.frame();
  EXPECT_THAT(cell.last_trace().touches, Contains(Field(&Touch::what, "part 0")));
}

TEST(PickVerdictTest, CollisionWithTheIntendedPartWhereTheJawsComeDownOnIt) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0, 0, 0.01), 0.02);
  const JudgedPick judged = scripted.judged(0);
  EXPECT_EQ(judged.verdict, PickVerdict::kCollision);
  EXPECT_THAT(judged.why, HasSubstr("jaw pressed on the intended part"));
}

TEST(PickVerdictTest, BrushingPastTheIntendedPartIsNone) {
  PickTrace trace;
  trace.has_closed = true;
  trace.lifted = trace.placed = {0};
  trace.touches.push_back({"jaw", "part 0", 0, true, 4.9, 0});
  EXPECT_EQ(judge(trace, 0).verdict, PickVerdict::kSuccess);
  trace.touches.push_back({"jaw", "part 1", 1, false, 20.0, 0});
  EXPECT_EQ(judge(trace, 0).verdict, PickVerdict::kSuccess) << "after closing";
  trace.touches.front().force_n = 5.1;
  EXPECT_EQ(judge(trace, 0).verdict, PickVerdict::kCollision) << "no brush any more";
}

TEST(PhysicsCellTest, WhatLosesItsSupportFalls) {
  // A box lies on two others, of which one is taken.
  ScriptedCell scripted({box_mesh({0.03, 0.05, 0.02}), box_mesh({0.08, 0.02, 0.01})},
                        {{0, at(0, 0, 0.01)}, {0, at(-0.06, 0, 0.01)}, {1, at(-0.035, 0, 0.025)}});
  scripted.pick(down_at(0, 0, 0.003), kWide_m);
  EXPECT_GT(scripted.judged(0).others_moved_m, 0.002);
  EXPECT_LT(scripted.cell->parts()[2].T_base_part.translation().z(), 0.022);
}

TEST(PhysicsCellTest, WhatDoesNotComeToRestInTimeIsLetStand) {
  for (const double settle_within_s : {0.01, 4.0}) {
    PhysicsCellOptions options = scripted_options();
    options.settle_within_s = settle_within_s;
    ScriptedCell scripted({box_mesh(kBox_m)}, {{0, at(0, 0, kBox_m.z() / 2)}}, options);
    hold(scripted);
    PhysicsCell& cell = *scripted.cell;
    cell.open(kBox_m.x() + 0.003);  // it falls
    const auto T_seen = [&] {
      cell.frame();
      return cell.parts()[0].T_base_part.matrix();
    };
    const Eigen::Matrix4d first = T_seen();
    EXPECT_EQ(first(2, 3) > kBox_m.z(), settle_within_s < 1) << first(2, 3);
    cell.wait(0.1);
    EXPECT_EQ(T_seen(), first);
  }
}

struct Outcome {
  PickTrace trace;
  std::vector<std::uint16_t> depth;
  std::vector<Eigen::Vector3d> p_base_m;
};

Outcome pick_from_pile(const simulation::Pile& pile, std::uint64_t seed) {
  PhysicsCellOptions options = scripted_options();
  options.seed = seed;
  ScriptedCell scripted({box_mesh(kBox_m)}, pile.parts, options);
  scripted.pick(down_at(0.01, 0.02, 0.03), 0.07);
  Outcome outcome{scripted.cell->last_trace(), scripted.cell->frame().depth, {}};
  for (const CellPart& part : scripted.cell->parts()) {
    outcome.p_base_m.push_back(part.T_base_part.translation());
  }
  return outcome;
}

TEST(PhysicsCellTest, FurtherFramesOfAPauseShowTheSameAndEndNoTrace) {
  ScriptedCell scripted = two_boxes(kAside);
  scripted.pick(down_at(0, 0, 0.01), kWide_m);
  PhysicsCell& cell = *scripted.cell;
  const DepthFrame first = cell.frame();
  const auto placed = cell.last_trace().placed;
  EXPECT_EQ(placed.size(), 1U);
  cell.wait(1.0 / 30);
  const DepthFrame second = cell.frame();
  EXPECT_EQ(cell.last_trace().placed, placed);
  EXPECT_NE(first.depth, second.depth);  // noise
  EXPECT_NEAR(first.at(255, 205), second.at(255, 205), 20);
  scripted.pick(down_at(-0.1, 0, 0.01), kWide_m);
  cell.frame();
  EXPECT_THAT(cell.last_trace().placed, ::testing::ElementsAre(1U));
}

TEST(PhysicsCellTest, PileAndSeedMakeWhatHappens) {
  const simulation::PileMaker boxes({box_mesh(kBox_m)});
  const auto pile = boxes.drop({25}, scripted_options().bin.inner_size_m, 1);
  ASSERT_TRUE(pile);
  const Outcome a = pick_from_pile(*pile, 1), b = pick_from_pile(*pile, 1);
  EXPECT_EQ(a.trace.moved_m, b.trace.moved_m);
  EXPECT_EQ(a.p_base_m, b.p_base_m);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_FALSE(a.trace.touches.empty());
  EXPECT_NE(a.depth, pick_from_pile(*pile, 2).depth);
}

}  // namespace
}  // namespace graspd::sim_cell
