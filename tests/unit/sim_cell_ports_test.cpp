#include <gmock/gmock.h>

#include "graspd/simulated/sim_cell.hpp"
#include "motion_support.hpp"
#include "scripted_cell.hpp"

/// The simulated cell behind the agent's ports, with an arm.
namespace graspd::agent {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

motion::MountedArm anno_above_the_bin() {
  motion::MotionParameters parameters;
  const graspd::Gripper& gripper = parameters.gripper;
  const double length_m = gripper.jaw_size_m.z() + gripper.palm_size_m.z();
  parameters.T_flange_grasp = testing::down_at(0, 0, -length_m);
  return {testing::anno(), parameters, testing::joints({0, -0.3, 0.2, 0, 1.4, 0})};
}

class SimCellPortsTest : public ::testing::Test {
 protected:
  static sim_cell::PhysicsCellOptions options() {
    sim_cell::PhysicsCellOptions options = testing::scripted_options();
    options.bin.T_base_bin.translation().x() = 0.35;
    options.place.T_base_bin.translation().x() = 0.9;
    options.T_base_camera = options.bin.T_base_bin * options.T_base_camera;
    return options;
  }
  static simulation::Pile one_box() {
    simulation::Pile pile;
    pile.parts.push_back({0, testing::at(0, 0, 0.02)});
    return pile;
  }
  /// To these joints, one second.
  Result<void> go(const Joints& q_rad) {
    return cell->joint_driver().follow({{0, *cell->joint_driver().joints()}, {1, q_rad}});
  }

  const std::vector<parts::Mesh> kinds{testing::box_mesh({0.03, 0.05, 0.04})};
  const motion::MountedArm arm = anno_above_the_bin();
  const std::unique_ptr<SimCell> cell = SimCell::create(kinds, one_box(), options(), arm).value();
};

TEST_F(SimCellPortsTest, TheArmCarriesTheGripper) {
  Joints q_rad = arm.out_of_view_rad;
  q_rad[0] += 0.5;
  ASSERT_TRUE(go(q_rad));
  const Eigen::Isometry3d expected = arm.model.T_base_flange(q_rad) * arm.parameters.T_flange_grasp;
  EXPECT_TRUE(cell->physics().T_base_grasp().isApprox(expected, 1e-5));
}

TEST_F(SimCellPortsTest, AnArmThatMeetsTheTableStopsThere) {
  Joints q_rad = arm.out_of_view_rad;
  q_rad[0] = M_PI / 2;  // beside the bin
  ASSERT_TRUE(go(q_rad));
  const Joints beside_rad = q_rad;
  q_rad[1] = -1.9;
  const auto done = go(q_rad);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("against table"));
  EXPECT_EQ(cell->physics().stalls_n(), 1);
  const Joints stopped_rad = *cell->joint_driver().joints();
  EXPECT_GT(stopped_rad[1], -1.9);
  cell->physics().frame();
  const sim_cell::JudgedPick judged = sim_cell::judge(cell->physics().last_trace(), 0);
  EXPECT_EQ(judged.verdict, sim_cell::PickVerdict::kCollision);
  EXPECT_THAT(judged.why, HasSubstr("table"));
  EXPECT_TRUE(go(beside_rad)) << "it comes free";
  EXPECT_EQ(cell->physics().stalls_n(), 1);
}

TEST_F(SimCellPortsTest, TimeIsTheMotionsAndThePlans) {
  class SlowPlanner final : public Planner {
   public:
    PlanReply plan(const DepthFrame&, const PlanRequest&) override {
      const auto end = std::chrono::steady_clock::now() + 20ms;
      while (std::chrono::steady_clock::now() < end) continue;
      return {"", PlanAnswer{}};
    }
  } planner;
  const auto start = cell->clock().now();
  ASSERT_TRUE(go(arm.out_of_view_rad));
  EXPECT_NEAR(std::chrono::duration<double>(cell->clock().now() - start).count(), 1, 1e-6);
  cell->clock().sleep_for(500ms);
  EXPECT_NEAR(std::chrono::duration<double>(cell->clock().now() - start).count(), 1.5, 1e-6);
  const auto before_plan = cell->clock().now();
  EXPECT_TRUE(cell->timed(planner).plan({}, {}).answer);
  EXPECT_GE(cell->clock().now() - before_plan, 20ms);
}

TEST_F(SimCellPortsTest, TheCameraSeesThePartAndStampsItsFrames) {
  const auto now = cell->clock().now();
  const auto frame = cell->camera().next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->stamp, now);
  // The box's top is 0.04 m above the floor that the camera stands 0.75 m above.
  EXPECT_NEAR((*frame)->at(255, 205) * (*frame)->depth_scale_m, 0.71, 0.005);
}

}  // namespace
}  // namespace graspd::agent
