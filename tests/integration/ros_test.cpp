#include <gmock/gmock.h>

#include "driven_arm.hpp"
#include "fake_ros_arm.hpp"
#include "graspd/ros/driver.hpp"
#include "temporary_folder.hpp"

/// The driver over ROS, with a real master and an arm that misbehaves.
namespace graspd::ros_arm {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RosDriver : public ::testing::Test {
 protected:
  static DriverOptions options() {
    DriverOptions options;
    options.joint_names = testing::FakeRosArm::joint_names();
    options.watchdog = 1000ms;
    options.limits.overtime = 300ms;
    return options;
  }
  static std::unique_ptr<agent::JointDriver> connect_driver() {
    auto driver = connect(options());
    EXPECT_TRUE(driver) << driver.error().message;
    return std::move(driver).value();
  }
  static Error error_of_motion(agent::JointDriver& driver, double duration_s) {
    const auto done =
        driver.follow({{0, agent::Joints::Zero(6)}, {duration_s, agent::Joints::Constant(6, 0.5)}});
    EXPECT_FALSE(done);
    return done ? Error{} : done.error();
  }

 private:
  /// Before the arm: it is a node.
  const bool has_master_ = (testing::need_ros_master(), true);

 protected:
  testing::FakeRosArm arm{{0, 0, 0, 0, 0, 0}};
};

TEST_F(RosDriver, ACellsConfigurationReachesIt) {
  const testing::TemporaryFolder folder;
  const auto path =
      folder.write("cell.yaml",
                   "cell: a\nparts: [{id: tee}]\ncamera: {path: scene}\n"
                   "T_base_camera: [1, 0, 0, 0.3, 0, -1, 0, 0, 0, 0, -1, 0.75, 0, 0, 0, 1]\n"
                   "bin: {T_base_bin: [1, 0, 0, 0.3, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],\n"
                   "      inner_size_m: [0.3, 0.24, 0.12]}\n"
                   "gripper: {output: {open: [\"true\"], close: [\"true\"]}}\n"
                   "T_base_place: [1, 0, 0, 0, 0, -1, 0, -0.31, 0, 0, -1, 0.07, 0, 0, 0, 1]\n"
                   "arm:\n  kind: ros\n  motion:\n    out_of_view_rad: [0.2, 0, 0, 0, 0, 0]\n"
                   "    T_flange_grasp: [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, -0.17, 0, 0, 0, 1]\n"
                   "    urdf: " GRASPD_SOURCE_DIR "/deploy/arms/probot_anno.urdf\n");
  const auto config = robot_agent::read_cell_config(path, folder.path());
  ASSERT_TRUE(config) << config.error().message;
  const auto driven = robot_agent::make_driven_arm(*config);
  ASSERT_TRUE(driven) << driven.error().message;
  const auto moved = (*driven)->move_out_of_view();
  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_NEAR(connect_driver()->joints().value()[0], 0.2, 0.01);
}

TEST_F(RosDriver, AnArmThatHaltsShortIsStoppedAndSaid) {
  const auto driver = connect_driver();
  arm.halt_in_motion();
  EXPECT_THAT(error_of_motion(*driver, 0.3).message,
              AllOf(HasSubstr("did not arrive"), HasSubstr("the arm was stopped")));
  EXPECT_EQ(arm.stops_n(), 1);
}

TEST_F(RosDriver, WhereStatesEndTheArmIsToldToStopAndItIsSaidThatNobodySawIt) {
  const auto driver = connect_driver();
  arm.fall_silent_in_motion();
  arm.ignore_stops();
  EXPECT_THAT(error_of_motion(*driver, 0.3).message,
              AllOf(HasSubstr("no state of the joints joint_1, joint_2"),
                    HasSubstr("use the emergency stop")));
  EXPECT_EQ(arm.stops_n(), 1);
}

TEST_F(RosDriver, AStopThatNobodySawIsAnError) {
  const auto driver = connect_driver();
  EXPECT_TRUE(driver->stop());
  arm.fall_silent_in_motion();
  arm.ignore_stops();
  static_cast<void>(error_of_motion(*driver, 0.3));
  const auto stopped = driver->stop();
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, HasSubstr("not seen to stand"));
}

TEST_F(RosDriver, AStopEndsAMotionThatFellSilent) {
  const auto driver = connect_driver();
  arm.fall_silent_in_motion();
  EXPECT_THAT(error_of_motion(*driver, 10).message, HasSubstr("the arm was stopped"));
  EXPECT_FALSE(arm.is_moving());
}

TEST_F(RosDriver, JointsThatNobodyKnowsAreNamed) {
  DriverOptions other = options();
  other.joint_names[2] = "elbow";
  const auto driver = connect(other);
  ASSERT_FALSE(driver);
  EXPECT_EQ(driver.error().code, Code::kUnavailable);
  EXPECT_THAT(driver.error().message, HasSubstr("joint_2, elbow"));
}

TEST_F(RosDriver, ATopicWithoutAnArmIsNamed) {
  DriverOptions other = options();
  other.command_topic = "no_such_arm";
  const auto driver = connect(other);
  ASSERT_FALSE(driver);
  EXPECT_THAT(driver.error().message, HasSubstr("nobody takes commands on '/no_such_arm'"));
}

}  // namespace
}  // namespace graspd::ros_arm
