#include <gmock/gmock.h>

#include "fake_controller.hpp"
#include "graspd/simple_message/driver.hpp"

/// The driver against a controller that misbehaves: whatever happens in mid-motion, the arm stands
/// in the end wherever a stop could still reach it, and the error says why.
namespace graspd::simple_message {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using testing::FakeController;
using ::testing::HasSubstr;
using testing::Misbehaviour;
using testing::StopAnswer;

class SimpleMessage : public ::testing::Test {
 protected:
  DriverOptions options() const {
    DriverOptions options;
    options.motion_port = controller.motion_port();
    options.state_port = controller.state_port();
    options.watchdog = 300ms;
    options.reply_timeout = 300ms;
    options.limits.overtime = 300ms;
    return options;
  }
  std::unique_ptr<agent::JointDriver> connect_driver() const {
    auto driver = connect(options());
    EXPECT_TRUE(driver) << driver.error().message;
    return driver ? *std::move(driver) : nullptr;
  }

  /// So long that a stop which is due after the watchdog's time is well before the goal.
  static agent::JointTrajectory far() {
    return {{0, agent::Joints::Zero(6)},
            {0.5, agent::Joints::Constant(6, 0.2)},
            {1.0, agent::Joints::Constant(6, 0.5)}};
  }

  Error error_of_motion(agent::JointDriver& driver) {
    const auto done = driver.follow(far());
    EXPECT_FALSE(done);
    return done ? Error{} : done.error();
  }

  void expect_stands_short() {
    EXPECT_FALSE(controller.is_moving());
    EXPECT_LT(controller.joints()[0], 0.49F);
  }

  FakeController controller{{0, 0, 0, 0, 0, 0}};
};

TEST_F(SimpleMessage, MoreJointsThanItsMessagesHaveRoomForAreRefused) {
  DriverOptions many = options();
  many.joints_n = 11;
  const auto driver = connect(many);
  ASSERT_FALSE(driver);
  EXPECT_EQ(driver.error().code, Code::kInvalidArgument);
  EXPECT_THAT(driver.error().message, HasSubstr("1 to 10 joints, not of 11"));
}

TEST_F(SimpleMessage, DownloadsATrajectoryAsControllersExpectIt) {
  ASSERT_TRUE(connect_driver()->follow(far()));
  const auto points = controller.points();
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].sequence, -1);
  EXPECT_EQ(points[1].sequence, 1);
  EXPECT_EQ(points[2].sequence, -3);
  EXPECT_FLOAT_EQ(points[1].duration_s, 0.5F);
  EXPECT_FLOAT_EQ(points[2].duration_s, 0.5F);  // since the last point
  EXPECT_FLOAT_EQ(points[1].velocity, static_cast<float>(0.2 / 0.5 / 3.0));
  EXPECT_FLOAT_EQ(points[2].velocity, static_cast<float>(0.3 / 0.5 / 3.0));
  for (const auto& point : points) {
    EXPECT_GT(point.duration_s, 0);
    EXPECT_GT(point.velocity, 0);
    EXPECT_LE(point.velocity, 1);
  }
  EXPECT_EQ(controller.stops_n(), 0);
}

TEST_F(SimpleMessage, AMotionOfOnePointIsDownloadedAsTwo) {
  const auto driver = connect_driver();
  ASSERT_TRUE(driver->follow({{0, agent::Joints::Zero(6)}}));
  // The arm stood at the goal before the points were read: two states later they are.
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(driver->joints());
  const auto points = controller.points();
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].sequence, -1);
  EXPECT_EQ(points[1].sequence, -3);
}

TEST_F(SimpleMessage, BytesMayComeOneByOneAndOtherMessagesBetweenThem) {
  controller.dribble();
  const auto driver = connect_driver();
  ASSERT_TRUE(driver->follow(far()));
  EXPECT_NEAR(driver->joints().value()[0], 0.5, 0.01);
}

TEST_F(SimpleMessage, AControllerThatCannotSayWhetherItMovesIsJudgedByItsJoints) {
  controller.hide_motion();
  ASSERT_TRUE(connect_driver()->follow(far()));
  EXPECT_FLOAT_EQ(controller.joints()[0], 0.5F);
}

struct Fault {
  Misbehaviour misbehaviour;
  std::string why;
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.why; }

class SimpleMessageFault : public SimpleMessage, public ::testing::WithParamInterface<Fault> {};

TEST_P(SimpleMessageFault, StopsTheArmAndSaysWhy) {
  const auto driver = connect_driver();
  controller.misbehave(GetParam().misbehaviour);
  const Error error = error_of_motion(*driver);
  EXPECT_THAT(error.message, AllOf(HasSubstr(GetParam().why), HasSubstr("the arm was stopped")));
  EXPECT_EQ(controller.stops_n(), 1);
  expect_stands_short();
}

INSTANTIATE_TEST_SUITE_P(
    Faults, SimpleMessageFault,
    ::testing::Values(Fault{Misbehaviour::kFallsSilent, "fell silent: no new joint positions"},
                      Fault{Misbehaviour::kStopsStatus, "fell silent: no new status"},
                      Fault{Misbehaviour::kClosesState, "closed the connection"},
                      Fault{Misbehaviour::kClosesMotion, "closed the connection"},
                      Fault{Misbehaviour::kEmergencyStop, "the emergency stop is pressed"},
                      Fault{Misbehaviour::kReportsError, "error 1234"},
                      Fault{Misbehaviour::kLosesPower, "no power"},
                      Fault{Misbehaviour::kGarbageOnState, "no simple message"},
                      Fault{Misbehaviour::kWrongLength, "joint position of 8 bytes"},
                      Fault{Misbehaviour::kCountsBack, "fell silent"},
                      Fault{Misbehaviour::kHalts, "did not arrive"},
                      Fault{Misbehaviour::kRefusesPoint, "refused a point"}),
    [](const auto& tested) { return "Number" + std::to_string(tested.index); });

TEST_F(SimpleMessage, GarbageOnTheMotionPortIsAnsweredWithAStopOnANewConnection) {
  const auto driver = connect_driver();
  controller.misbehave(Misbehaviour::kGarbageOnMotion);
  EXPECT_THAT(error_of_motion(*driver).message,
              AllOf(HasSubstr("no simple message"), HasSubstr("the arm was stopped")));
  expect_stands_short();
}

TEST_F(SimpleMessage, AnArmThatNeverSettlesIsStopped) {
  const auto driver = connect_driver();
  controller.misbehave(Misbehaviour::kNeverSettles);
  const Error error = error_of_motion(*driver);
  EXPECT_EQ(error.code, Code::kDeadlineExceeded);
  EXPECT_FALSE(controller.is_moving());
}

TEST_F(SimpleMessage, WhereTheControllerIsGoneTheErrorSaysThatNobodyConfirmedTheStop) {
  const auto driver = connect_driver();
  controller.misbehave(Misbehaviour::kVanishes);
  EXPECT_THAT(error_of_motion(*driver).message,
              AllOf(HasSubstr("closed the connection"), HasSubstr("use the emergency stop")));
  const auto after = driver->joints();
  ASSERT_FALSE(after);
  EXPECT_EQ(after.error().code, Code::kUnavailable);
}

TEST_F(SimpleMessage, AStopThatIsNotConfirmedIsAskedForTwiceAndThenSaid) {
  const std::pair<StopAnswer, std::string> cases[] = {
      {StopAnswer::kNothing, "did not answer"},
      {StopAnswer::kOtherSequence, "did not answer the stop, but sequence 7"},
      {StopAnswer::kRefuses, "refused to stop"}};
  for (const auto& [answer, why] : cases) {
    FakeController other({0, 0, 0, 0, 0, 0});
    other.misbehave(Misbehaviour::kReportsError);
    other.answer_stops(answer);
    DriverOptions to_other = options();
    to_other.motion_port = other.motion_port();
    to_other.state_port = other.state_port();
    const auto driver = connect(to_other);
    ASSERT_TRUE(driver);
    EXPECT_THAT(error_of_motion(**driver).message,
                AllOf(HasSubstr("error 1234"), HasSubstr(why), HasSubstr("not confirmed")));
    EXPECT_EQ(other.stops_n(), 2);
  }
}

TEST_F(SimpleMessage, AfterAnEmergencyStopIsReleasedTheArmMovesAgain) {
  const auto driver = connect_driver();
  controller.set_e_stop(true);
  EXPECT_THAT(error_of_motion(*driver).message,
              AllOf(HasSubstr("does not move"), HasSubstr("emergency stop")));
  EXPECT_TRUE(controller.points().empty());  // nothing was sent
  controller.set_e_stop(false);
  EXPECT_TRUE(driver->follow(far()));
}

TEST_F(SimpleMessage, StopsOnDemand) {
  const auto driver = connect_driver();
  EXPECT_TRUE(driver->stop());
  EXPECT_EQ(controller.stops_n(), 1);
}

TEST_F(SimpleMessage, AStopOnDemandThatIsNotConfirmedIsSaid) {
  const auto driver = connect_driver();
  controller.answer_stops(StopAnswer::kRefuses);
  const auto stopped = driver->stop();
  ASSERT_FALSE(stopped);
  EXPECT_THAT(stopped.error().message, HasSubstr("refused to stop"));
}

TEST_F(SimpleMessage, AControllerThatIsNotThereIsNamed) {
  DriverOptions nobody = options();
  {
    const FakeController gone({0, 0, 0, 0, 0, 0});
    nobody.motion_port = gone.motion_port();
  }
  const auto driver = connect(nobody);
  ASSERT_FALSE(driver);
  EXPECT_EQ(driver.error().code, Code::kUnavailable);
  EXPECT_THAT(
      driver.error().message,
      AllOf(HasSubstr(fmt::format("127.0.0.1:{}", nobody.motion_port)), HasSubstr("refused")));
}

TEST_F(SimpleMessage, AHostThatIsNoneIsNamed) {
  DriverOptions nowhere = options();
  nowhere.host = "no.such.host.invalid";
  const auto driver = connect(nowhere);
  ASSERT_FALSE(driver);
  EXPECT_THAT(driver.error().message, HasSubstr("no.such.host.invalid"));
}

}  // namespace
}  // namespace graspd::simple_message
