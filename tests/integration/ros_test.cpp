#include <gmock/gmock.h>

#include "fake_ros_arm.hpp"
#include "graspd/ros/driver.hpp"

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
