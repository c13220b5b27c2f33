#include <gmock/gmock.h>
#include <stdlib.h>

#include "graspd/openni2/openni2_camera.hpp"
#include "system_clock.hpp"

/// The camera through the real OpenNI2, with a driver of our own in the place of a device's
/// (tests/support/openni2_driver.cpp).
namespace graspd::openni2 {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class OpenNi2 : public ::testing::Test {
 protected:
  void SetUp() override { misbehave("none"); }
  static void misbehave(const char* how) { setenv("GRASPD_CAMERA", how, 1); }

  static CameraOptions kinect_v2() {
    CameraOptions options;
    options.camera = {512, 424, 365.5, 365.5, 256, 205, {}};
    return options;
  }
  std::unique_ptr<agent::Camera> open(const CameraOptions& options) {
    auto camera = open_camera(options, clock);
    EXPECT_TRUE(camera) << camera.error().message;
    return std::move(camera).value();
  }
  Error error_of(const CameraOptions& options) {
    const auto camera = open_camera(options, clock);
    EXPECT_FALSE(camera);
    return camera ? Error{} : camera.error();
  }
  /// Frames are mirrored back, so their counter is at the right.
  static int number_of(const Result<std::optional<DepthFrame>>& frame) {
    return (*frame)->at(511, 0);
  }

  robot_agent::SystemClock clock;
};

TEST_F(OpenNi2, GivesFramesOfTheModeThatWasAskedForMirroredBack) {
  const auto frame = open(kinect_v2())->next();
  ASSERT_TRUE(frame && *frame) << frame.error().message;
  EXPECT_EQ((*frame)->camera.width_px, 512);
  EXPECT_EQ((*frame)->camera.fx_px, 365.5);
  EXPECT_EQ((*frame)->depth_scale_m, 0.001);
  ASSERT_TRUE(validate(**frame));
  for (const int v : {1, 423}) {
    EXPECT_EQ((*frame)->at(0, v), 600 + 511);
    EXPECT_EQ((*frame)->at(511, v), 600);
  }
}

TEST_F(OpenNi2, ACameraThatIsNotMirroredIsLeftAsItIs) {
  CameraOptions options = kinect_v2();
  options.is_mirrored = false;
  const auto frame = open(options)->next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->at(100, 7), 700);
}

TEST_F(OpenNi2, CorrectsTheDepth) {
  CameraOptions options = kinect_v2();
  options.depth_correction = {{-0.012, 0, 0, 0, 0, 0}, {}, 0.7, 0.5, 1.2};
  const auto frame = open(options)->next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->at(411, 7), 700 - 12);
}

TEST_F(OpenNi2, NoFrameIsOlderThanTheCall) {
  const auto camera = open(kinect_v2());
  int last = 0;
  for (int i = 0; i < 5; ++i) {
    const auto frame = camera->next();
    ASSERT_TRUE(frame && *frame);
    EXPECT_GE(number_of(frame), last + 2);
    last = number_of(frame);
  }
}

TEST_F(OpenNi2, AFrameIsStampedByWhenItsExposureCanHaveBegunAtTheLatest) {
  const auto camera = open(kinect_v2());
  for (int i = 0; i < 3; ++i) {
    const auto call = clock.now();
    const auto frame = camera->next();
    ASSERT_TRUE(frame && *frame);
    ASSERT_TRUE((*frame)->stamp);
    EXPECT_GE(*(*frame)->stamp, call);
    EXPECT_LE(*(*frame)->stamp, clock.now() - 1s / 30);
  }
}

TEST_F(OpenNi2, FramesThatArriveAtOnceAreStampedFromBeforeTheCall) {
  misbehave("eager");
  const auto camera = open(kinect_v2());
  for (int i = 0; i < 3; ++i) {
    const auto call = clock.now();
    const auto frame = camera->next();
    ASSERT_TRUE(frame && *frame);
    EXPECT_LT((*frame)->stamp, call) << "the pick cycle would plan on it";
  }
}

TEST_F(OpenNi2, ACameraMayBeOpenedAgain) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(open(kinect_v2())->next());
}

TEST_F(OpenNi2, NoDeviceIsSaid) {
  misbehave("absent");
  const Error error = error_of(kinect_v2());
  EXPECT_EQ(error.code, Code::kUnavailable);
  EXPECT_THAT(error.message, AllOf(HasSubstr("no depth camera"), HasSubstr("plugged in")));
}

TEST_F(OpenNi2, AnotherDeviceIsSaid) {
  CameraOptions options = kinect_v2();
  options.uri = "no-such-device";
  EXPECT_THAT(error_of(options).message, HasSubstr("no depth camera at 'no-such-device'"));
}

TEST_F(OpenNi2, ADeviceWithoutTheModeIsSaidWithTheModesItHas) {
  misbehave("vga_only");
  EXPECT_THAT(error_of(kinect_v2()).message,
              AllOf(HasSubstr("no depth mode 512x424 at 30"), HasSubstr("it has 640x480 at 30")));
}

TEST_F(OpenNi2, FramesOfAnotherSizeAreRefused) {
  misbehave("wrong_size");
  const auto frame = open(kinect_v2())->next();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, AllOf(HasSubstr("512 × 212"), HasSubstr("512 × 424")));
}

TEST_F(OpenNi2, ASilentCameraIsSaid) {
  CameraOptions options = kinect_v2();
  options.timeout = 50ms;
  misbehave("silent");
  const auto frame = open(options)->next();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, Code::kUnavailable);
  EXPECT_THAT(frame.error().message, HasSubstr("no frame of the camera for 0.1 s"));
}

TEST_F(OpenNi2, ACameraThatDiesIsSaid) {
  CameraOptions options = kinect_v2();
  options.timeout = 200ms;
  misbehave("dies");
  const auto camera = open(options);
  for (int i = 0; i < 3; ++i) {
    if (const auto frame = camera->next(); !frame) {
      EXPECT_THAT(frame.error().message, HasSubstr("still plugged in"));
      return;
    }
  }
  FAIL() << "six frames of a camera that gives four";
}

TEST_F(OpenNi2, IntrinsicsThatAreNoneAreRefused) {
  CameraOptions options = kinect_v2();
  options.camera.fx_px = 0;
  EXPECT_EQ(error_of(options).code, Code::kInvalidArgument);
}

}  // namespace
}  // namespace graspd::openni2
