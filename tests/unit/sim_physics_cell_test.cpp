#include <gmock/gmock.h>

#include "scripted_cell.hpp"

namespace graspd::sim_cell {
namespace {

using testing::at;
using testing::box_mesh;
using testing::down_at;
using testing::scripted_options;
using testing::ScriptedCell;

const Eigen::Vector3d kBox_m(0.03, 0.05, 0.04);
constexpr double kWide_m = 0.045;
constexpr double kGravity_m_s2 = 9.81;

struct Held {
  double slip_m = 0;  ///< through the jaws, in two seconds over the table
  double height_m = 0;
};

Held hold_box(const PhysicsCellOptions& options) {
  ScriptedCell scripted({box_mesh(kBox_m)}, {{0, at(0, 0, kBox_m.z() / 2)}}, options);
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

/// Both jaws' friction as a share of the box's weight.
PhysicsCellOptions gripping_with(double share) {
  const PileOptions parts;
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

TEST(PhysicsCellTest, APartIsPickedAndPlaced) {
  ScriptedCell scripted({box_mesh(kBox_m)}, {{0, at(0, 0, 0.02)}});
  scripted.pick(down_at(0, 0, 0.01), kWide_m);
  const auto judged = scripted.judged(0);
  EXPECT_EQ(judged.verdict, PickVerdict::kSuccess) << judged.why;
}

}  // namespace
}  // namespace graspd::sim_cell
