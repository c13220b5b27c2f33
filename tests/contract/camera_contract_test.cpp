#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "fake_clock.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "graspd/replay/replay_camera.hpp"
#include "temporary_folder.hpp"

/// What every camera that replays a recording must do, run on each kind of recording.
namespace graspd::replay {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Frame k has depths that tell it from all others.
DepthFrame frame_number(int k, int width_px = 24, int height_px = 16) {
  DepthFrame frame;
  frame.camera = {width_px, height_px, 365.5, 366.25, 11.5, 8.25, {0.09, -0.27, 0, 0, 0.1}};
  for (int i = 0; i < width_px * height_px; ++i) {
    // Noise, so that a cut through the compressed file cuts a frame.
    frame.depth.push_back(static_cast<std::uint16_t>(700 + 100 * k + (i * 7919 + k * 104729) % 97));
  }
  return frame;
}

void write_bop(const std::filesystem::path& path, const std::vector<DepthFrame>& frames) {
  std::filesystem::create_directories(path);
  BopSceneWriter writer(path);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    BopImage image;
    image.im_id = static_cast<int>(3 * i);  // numbers need not follow each other
    image.frame = frames[i];
    ASSERT_TRUE(writer.add(image));
  }
  ASSERT_TRUE(writer.finish());
}

void write_rawlog(const std::filesystem::path& path, const std::vector<DepthFrame>& frames) {
  auto writer = RawlogWriter::create(path);
  ASSERT_TRUE(writer);
  double stamp_s = 1e9;
  for (const DepthFrame& frame : frames) ASSERT_TRUE(writer->add(frame, stamp_s += 0.033));
}

void cut(const std::filesystem::path& file, double kept_share) {
  const auto size = static_cast<double>(std::filesystem::file_size(file));
  std::filesystem::resize_file(file, static_cast<std::uintmax_t>(size * kept_share));
}

class CameraContract : public ::testing::TestWithParam<RecordingKind> {
 protected:
  bool is_bop() const { return GetParam() == RecordingKind::kBop; }
  std::filesystem::path path() const { return folder_.path() / (is_bop() ? "000001" : "a.rawlog"); }

  void write(const std::vector<DepthFrame>& frames) {
    is_bop() ? write_bop(path(), frames) : write_rawlog(path(), frames);
  }
  void write_numbered(int frames_n) {
    std::vector<DepthFrame> frames;
    for (int k = 0; k < frames_n; ++k) frames.push_back(frame_number(k));
    write(frames);
  }
  /// Cuts through the last of two frames.
  void damage_last_of_two() {
    is_bop() ? cut(path() / "depth" / "000003.png", 0.5) : cut(path(), 0.75);
  }

  std::unique_ptr<agent::Camera> open(const ReplayOptions& options = {}) {
    auto camera = open_recording(GetParam(), path(), options, clock);
    EXPECT_TRUE(camera) << camera.error().message;
    return camera ? *std::move(camera) : nullptr;
  }

  /// The numbers of all frames, `most` at most.
  static std::vector<int> numbers(agent::Camera& camera, std::size_t most = 100) {
    std::vector<int> numbers;
    while (numbers.size() < most) {
      const auto frame = camera.next();
      if (!frame || !*frame) break;
      numbers.push_back(((*frame)->at(0, 0) - 700) / 100);
    }
    return numbers;
  }

  agent::fakes::FakeClock clock;

 private:
  testing::TemporaryFolder folder_;
};

TEST_P(CameraContract, GivesTheFramesAsTheyWereRecorded) {
  write_numbered(2);
  const auto camera = open();
  for (int k = 0; k < 2; ++k) {
    const auto frame = camera->next();
    ASSERT_TRUE(frame && *frame);
    const DepthFrame expected = frame_number(k);
    EXPECT_EQ((*frame)->depth, expected.depth);
    EXPECT_EQ((*frame)->depth_scale_m, expected.depth_scale_m);
    const CameraIntrinsics& intrinsics = (*frame)->camera;
    EXPECT_EQ(intrinsics.width_px, 24);
    EXPECT_EQ(intrinsics.height_px, 16);
    EXPECT_DOUBLE_EQ(intrinsics.fx_px, 365.5);
    EXPECT_DOUBLE_EQ(intrinsics.fy_px, 366.25);
    EXPECT_DOUBLE_EQ(intrinsics.cx_px, 11.5);
    EXPECT_DOUBLE_EQ(intrinsics.cy_px, 8.25);
    for (std::size_t i = 0; i < intrinsics.distortion.size(); ++i) {
      EXPECT_NEAR(intrinsics.distortion[i], expected.camera.distortion[i], 1e-6);
    }
  }
}

TEST_P(CameraContract, KeepsTheOrderAndStaysAtTheEnd) {
  write_numbered(5);
  const auto camera = open();
  EXPECT_THAT(numbers(*camera), ElementsAre(0, 1, 2, 3, 4));
  for (int i = 0; i < 2; ++i) {
    const auto after = camera->next();
    ASSERT_TRUE(after);
    EXPECT_FALSE(*after);
  }
  EXPECT_THAT(clock.sleeps, IsEmpty());
}

TEST_P(CameraContract, StartsAgainWhenLooped) {
  write_numbered(2);
  const auto camera = open({.loop = true});
  EXPECT_THAT(numbers(*camera, 5), ElementsAre(0, 1, 0, 1, 0));
}

TEST_P(CameraContract, GivesNoMoreFramesThanAskedFor) {
  write_numbered(2);
  EXPECT_THAT(numbers(*open({.max_frames_n = 1})), ElementsAre(0));
  EXPECT_THAT(numbers(*open({.max_frames_n = 9})), ElementsAre(0, 1));
  EXPECT_THAT(numbers(*open({.loop = true, .max_frames_n = 3})), ElementsAre(0, 1, 0));
  EXPECT_THAT(numbers(*open({.max_frames_n = 0})), IsEmpty());
}

TEST_P(CameraContract, PacesItsFrames) {
  write_numbered(4);
  const auto camera = open({.period = 100ms});
  ASSERT_TRUE(camera->next());
  EXPECT_THAT(clock.sleeps, IsEmpty());
  clock.advance(30ms);
  ASSERT_TRUE(camera->next());
  EXPECT_THAT(clock.sleeps, ElementsAre(70ms));
  clock.advance(250ms);  // late: the frame comes at once, and the next is no earlier for it
  ASSERT_TRUE(camera->next());
  EXPECT_THAT(clock.sleeps, ElementsAre(70ms));
  ASSERT_TRUE(camera->next());
  EXPECT_THAT(clock.sleeps, ElementsAre(70ms, 100ms));
}

TEST_P(CameraContract, ADamagedRecordingGivesWhatCanBeReadAndThenSaysWhereItBroke) {
  write_numbered(2);
  damage_last_of_two();
  const auto camera = open();
  EXPECT_THAT(numbers(*camera), ElementsAre(0));
  for (int i = 0; i < 2; ++i) {
    const auto broken = camera->next();
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().code, Code::kInvalidArgument);
    EXPECT_THAT(broken.error().message,
                AllOf(HasSubstr(path().string()), HasSubstr("broken after 1")));
  }
}

TEST_P(CameraContract, AMissingRecordingIsNamed) {
  const auto camera = open_recording(GetParam(), path(), {}, clock);
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, Code::kInvalidArgument);
  EXPECT_THAT(camera.error().message, HasSubstr(path().string()));
}

TEST_P(CameraContract, SomethingElseThanARecordingIsNamed) {
  // A file where a folder should be, and the other way round.
  is_bop() ? static_cast<void>(std::ofstream(path()) << "no scene")
           : static_cast<void>(std::filesystem::create_directory(path()));
  const auto camera = open_recording(GetParam(), path(), {}, clock);
  ASSERT_FALSE(camera);
  EXPECT_THAT(camera.error().message, HasSubstr(path().string()));
}

TEST_P(CameraContract, FramesOfAnotherSizeAreRefused) {
  write({frame_number(0), frame_number(1, 16, 24)});
  const auto camera = open();
  EXPECT_THAT(numbers(*camera), ElementsAre(0));
  const auto other = camera->next();
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, Code::kInvalidArgument);
  EXPECT_THAT(other.error().message,
              AllOf(HasSubstr("frame 1"), HasSubstr("16 × 24"), HasSubstr("24 × 16")));
}

TEST_P(CameraContract, ACalibrationTakesThePlaceOfTheRecordedIntrinsics) {
  write_numbered(1);
  CameraIntrinsics calibrated = frame_number(0).camera;
  calibrated.fx_px = 370;
  const auto frame = open({.intrinsics = calibrated})->next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->camera.fx_px, 370);
}

TEST_P(CameraContract, ACalibrationForAnotherSizeIsRefused) {
  write_numbered(1);
  CameraIntrinsics calibrated = frame_number(0).camera;
  calibrated.width_px = 512;
  const auto frame = open({.intrinsics = calibrated})->next();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, AllOf(HasSubstr("24 × 16"), HasSubstr("512 × 16")));
}

TEST_P(CameraContract, ARecordingWithoutFramesIsNoEndlessLoop) {
  write({});
  const auto camera = open_recording(GetParam(), path(), {.loop = true}, clock);
  if (!camera) {  // a scene without images is none
    EXPECT_THAT(camera.error().message, HasSubstr(path().string()));
    return;
  }
  const auto frame = (*camera)->next();
  ASSERT_TRUE(frame);
  EXPECT_FALSE(*frame);
}

INSTANTIATE_TEST_SUITE_P(Recordings, CameraContract,
                         ::testing::Values(RecordingKind::kBop, RecordingKind::kRawlog),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

}  // namespace
}  // namespace graspd::replay
