#include <gmock/gmock.h>
#include <stdlib.h>

#include <functional>

#include "fake_clock.hpp"
#include "graspd/agent/averaging_camera.hpp"
#include "graspd/formats/bop.hpp"
#include "graspd/openni2/openni2_camera.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "graspd/replay/replay_camera.hpp"
#include "graspd/simulated/sim_cell.hpp"
#include "named.hpp"
#include "scripted_cell.hpp"
#include "temporary_folder.hpp"

/// What every camera must do, recorded, simulated or real: `camera_contract_test.cpp` goes on with
/// what only recordings must. Another camera is a function that opens it, and its line in
/// `kBreakableCameras` or `kUnbreakableCameras`.
namespace graspd::agent {
namespace {

using namespace std::chrono_literals;

const CameraIntrinsics kCamera{512, 424, 365.5, 366.25, 255.5, 205.25, {0.09, -0.27, 0, 0, 0.1}};
constexpr std::uint64_t kFrames = 2;  ///< before a camera that breaks is broken

DepthFrame recorded_frame() {
  DepthFrame frame{kCamera, 0.001, std::vector<std::uint16_t>(512 * 424)};
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    frame.depth[i] = static_cast<std::uint16_t>(700 + i * 7919 % 97);
  }
  return frame;
}

/// Where a camera lives while it is tested.
struct Scene {
  testing::TemporaryFolder folder;
  fakes::FakeClock fake_clock;
  std::vector<parts::Mesh> kinds;
  std::unique_ptr<SimCell> cell;

  /// What frames are stamped by.
  Clock& clock() { return cell ? cell->clock() : fake_clock; }
};
/// \param breaks after `kFrames` frames.
using Open = std::function<std::shared_ptr<Camera>(Scene&, bool breaks)>;

std::unique_ptr<Camera> replay_of(replay::RecordingKind kind, const std::filesystem::path& path,
                                  Scene& scene) {
  return replay::open_recording(kind, path, {.intrinsics = kCamera}, scene.fake_clock).value();
}

std::unique_ptr<Camera> open_bop(Scene& scene, bool breaks) {
  const auto path = scene.folder.path() / "000001";
  std::filesystem::create_directories(path);
  BopSceneWriter writer(path);
  for (int i = 0; i < 3; ++i) {
    BopImage image;
    image.im_id = i;
    image.frame = recorded_frame();
    EXPECT_TRUE(writer.add(image));
  }
  EXPECT_TRUE(writer.finish());
  if (breaks) std::filesystem::resize_file(path / "depth" / "000002.png", 1000);
  return replay_of(replay::RecordingKind::kBop, path, scene);
}

std::unique_ptr<Camera> open_rawlog(Scene& scene, bool breaks) {
  const auto path = scene.folder.path() / "a.rawlog";
  {
    auto writer = RawlogWriter::create(path).value();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(writer.add(recorded_frame(), 1e9 + i));
  }
  if (breaks) {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * 5 / 6);
  }
  return replay_of(replay::RecordingKind::kRawlog, path, scene);
}

std::unique_ptr<Camera> open_openni2(Scene& scene, bool breaks) {
  setenv("GRASPD_CAMERA", breaks ? "dies" : "none", 1);
  openni2::CameraOptions options;
  options.camera = kCamera;
  options.timeout = 500ms;
  return openni2::open_camera(options, scene.fake_clock).value();
}

std::unique_ptr<Camera> open_averaging(Scene& scene, bool breaks) {
  return std::make_unique<AveragingCamera>(open_openni2(scene, breaks), 2);
}

std::shared_ptr<Camera> open_simulated(Scene& scene, bool /*never*/) {
  sim_cell::PhysicsCellOptions options = testing::scripted_options();
  options.sensor.camera = kCamera;
  scene.cell = SimCell::create(scene.kinds, {}, options, FloatingOptions()).value();
  return {std::shared_ptr<void>(), &scene.cell->camera()};
}

using NamedCamera = testing::Named<Open>;

const NamedCamera kBreakableCameras[] = {
    {"bop", open_bop},
    {"rawlog", open_rawlog},
    {"openni2", open_openni2},
    {"averaging", open_averaging},
};
const NamedCamera kUnbreakableCameras[] = {
    {"simulated", open_simulated},
};

class EveryCamera : public ::testing::TestWithParam<NamedCamera> {
 protected:
  Scene scene;
};

TEST_P(EveryCamera, GivesFramesThatAPlanCanBeMadeOf) {
  const auto camera = GetParam().make(scene, false);
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto frame = camera->next();
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_TRUE(*frame);
    const auto ok = validate(**frame);
    EXPECT_TRUE(ok) << ok.error().message;
  }
}

TEST_P(EveryCamera, GivesTheIntrinsicsItWasCalibratedTo) {
  const auto frame = GetParam().make(scene, false)->next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->camera.width_px, kCamera.width_px);
  EXPECT_EQ((*frame)->camera.height_px, kCamera.height_px);
  EXPECT_EQ((*frame)->camera.fx_px, kCamera.fx_px);
  EXPECT_EQ((*frame)->camera.cx_px, kCamera.cx_px);
  EXPECT_EQ((*frame)->camera.distortion, kCamera.distortion);
}

/// A frame from before the arm's last motion is known by nothing else.
TEST_P(EveryCamera, StampsByTheCellsClockOrNotAtAll) {
  const auto camera = GetParam().make(scene, false);
  std::optional<std::chrono::nanoseconds> last;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const auto frame = camera->next();
    ASSERT_TRUE(frame && *frame);
    const auto stamp = (*frame)->stamp;
    if (!stamp) continue;
    EXPECT_LE(*stamp, scene.clock().now()) << "it was not yet exposed";
    EXPECT_GT(*stamp, scene.clock().now() - 1s) << "another clock's";
    EXPECT_GE(*stamp, last.value_or(*stamp));
    last = stamp;
  }
}

class BreakableCamera : public EveryCamera {};

TEST_P(BreakableCamera, OnceBrokenSaysSoAgainAndAgain) {
  const auto camera = GetParam().make(scene, true);
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    if (!camera->next()) break;  // a real one may have had frames that nobody asked for
  }
  for (int i = 0; i < 2; ++i) {
    const auto frame = camera->next();
    ASSERT_FALSE(frame);
    EXPECT_FALSE(frame.error().message.empty());
  }
}

const auto name_of_camera = [](const auto& tested) { return tested.param.name; };
INSTANTIATE_TEST_SUITE_P(Breakable, EveryCamera, ::testing::ValuesIn(kBreakableCameras),
                         name_of_camera);
INSTANTIATE_TEST_SUITE_P(Unbreakable, EveryCamera, ::testing::ValuesIn(kUnbreakableCameras),
                         name_of_camera);
INSTANTIATE_TEST_SUITE_P(Cameras, BreakableCamera, ::testing::ValuesIn(kBreakableCameras),
                         name_of_camera);

}  // namespace
}  // namespace graspd::agent
