#include "agent_fixture.hpp"

/// The real agent with a depth camera over OpenNI2, and in its place the driver of
/// support/openni2_driver.cpp: the pixel in column u reads 600 + u mm.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kWidth_px = 512;
constexpr std::size_t kColumn = 100;

class LiveCameraTest : public AgentTest {
 protected:
  /// \param more keys of the camera.
  std::filesystem::path write_live_config(const std::string& more) const {
    return folder.write(
        "live.yaml",
        fmt::format("cell: live\nservers: ['{}']\nparts: [{{id: bar}}]\nrecords: live_records\n"
                    "camera: {{kind: openni2, calibration: camera.yaml{}}}\n"
                    "T_base_place: [1, 0, 0, 0.4, 0, -1, 0, 0, 0, 0, -1, 0.1, 0, 0, 0, 1]\n",
                    shared_->server->data_endpoint, more));
  }
  Finished agent_with_camera(const std::filesystem::path& config,
                             const std::string& fault = "none") const {
    return run(fmt::format("GRASPD_CAMERA={} LD_LIBRARY_PATH={} {} run --config {} --out {}", fault,
                           OPENNI2_FOLDER, ROBOT_AGENT, config.string(), folder.path().string()));
  }
  /// The depth in a column of the first frame that the run kept.
  double kept_depth_mm() const {
    const auto frames = BopScene::open(run_folder("live") / "frames");
    const DepthFrame frame = frames.value().read(0).value().frame;
    return 1e3 * frame.depth_scale_m * frame.at(kColumn, 10);
  }
};

TEST_F(LiveCameraTest, ItsFramesAreMirroredBackAndCorrected) {
  const auto camera = write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m);
  std::ofstream(camera, std::ios::app)
      << "depth_correction: {offset_m: [0.01, 0, 0, 0, 0, 0], slope: [0, 0, 0, 0, 0, 0],\n"
         "  reference_m: 0.7, min_depth_m: 0.5, max_depth_m: 1.5}\n";
  const Finished finished = agent_with_camera(write_live_config(""));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;  // a plane, and nothing on it
  EXPECT_DOUBLE_EQ(kept_depth_mm(), 600 + (kWidth_px - 1 - kColumn) + 10);
}

TEST_F(LiveCameraTest, AsTheDriverGivesThemWhereThatDoesNotMirror) {
  write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m);
  const Finished finished = agent_with_camera(write_live_config(", mirrored: false"));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_DOUBLE_EQ(kept_depth_mm(), 600 + kColumn);
}

TEST_F(LiveCameraTest, ACameraThatIsAbsentOrDiesIsNamed) {
  write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m);
  const Finished absent = agent_with_camera(write_live_config(""), "absent");
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_THAT(absent.output, HasSubstr("no depth camera"));
  const Finished silent = agent_with_camera(write_live_config(", timeout_s: 0.2"), "silent");
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.output, AllOf(HasSubstr("stopped, 0 parts placed: camera: no frame"),
                                   HasSubstr("is it still plugged in?")));
}

TEST_F(LiveCameraTest, TheReferenceOfARealCellIsOneWithAndWithoutItsOptionalKeys) {
  const std::filesystem::path cells = std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/cells";
  std::filesystem::copy(cells / "anno_camera.yaml", folder.path() / "anno_camera.yaml");
  const auto full = folder.write("anno.yaml", with_every_key(cells / "anno.yaml"));
  for (const auto& config : {cells / "anno.yaml", full}) {
    const Finished finished = agent_with_camera(config, "absent");
    EXPECT_EQ(finished.exit_code, 1);
    EXPECT_THAT(finished.output, HasSubstr("no depth camera"));
  }
}

TEST_F(LiveCameraTest, ItIsNoRecording) {
  write_camera(folder, "camera.yaml", kinect_v2(), kHeight_m);
  const Finished finished = agent(write_live_config(""), "--frames 3");
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("--frames are for a cell that replays"));
}

}  // namespace
}  // namespace graspd::testing
