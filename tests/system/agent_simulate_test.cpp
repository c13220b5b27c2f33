#include <gmock/gmock.h>

#include "graspd/formats/bop.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/recordings/rawlog.hpp"
#include "serve_process.hpp"
#include "temporary_folder.hpp"

/// `robot_agent simulate`, as a real process that writes real files.
namespace graspd::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class AgentSimulateTest : public ::testing::Test {
 protected:
  static Finished simulate(const std::string& options) {
    return run(fmt::format("{} simulate --parts {}/deploy/parts {}", ROBOT_AGENT, GRASPD_SOURCE_DIR,
                           options));
  }
  std::string out(const std::string& name) const { return (folder.path() / name).string(); }

  static std::vector<DepthFrame> bop_frames(const std::string& path) {
    std::vector<DepthFrame> frames;
    const auto scene = BopScene::open(path);
    EXPECT_TRUE(scene);
    for (const int im_id : scene->image_ids()) frames.push_back(scene->read(im_id)->frame);
    return frames;
  }

  TemporaryFolder folder;
};

TEST_F(AgentSimulateTest, WritesTheSameFramesAsBopSceneAndRawlog) {
  const Finished finished = simulate("--part tee=2 --part elbow=1 --frames 2 --out " + out("a"));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("2 frames, 6 parts"));
  const auto frames = bop_frames(out("a"));
  ASSERT_EQ(frames.size(), 2u);
  auto rawlog = RawlogReader::open(out("a") + "/frames.rawlog");
  ASSERT_TRUE(rawlog);
  for (const DepthFrame& frame : frames) {
    const auto recorded = rawlog->next();
    ASSERT_TRUE(recorded && *recorded);
    EXPECT_EQ((*recorded)->frame.depth, frame.depth);
  }
  EXPECT_NE(frames[0].depth, frames[1].depth);
}

TEST_F(AgentSimulateTest, WritesCameraAndBinForTheCommandLine) {
  const Finished finished =
      simulate("--part tee=1 --camera-height-m 0.8 --bin-size-m 0.4 0.3 0.1 --out " + out("a"));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const auto camera = read_camera(out("a") + "/camera.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  const auto cell = read_cell(out("a") + "/cell.yaml");
  ASSERT_TRUE(cell) << cell.error().message;
  ASSERT_TRUE(cell->bin);
  EXPECT_TRUE(cell->bin->inner_size_m.isApprox(Eigen::Vector3d(0.4, 0.3, 0.1)));
  const Eigen::Isometry3d T_camera_bin = camera->T_base_camera->inverse() * cell->bin->T_base_bin;
  EXPECT_NEAR(T_camera_bin.translation().z(), 0.8, 1e-9);
  EXPECT_EQ(camera->camera.width_px, 512);
}

TEST_F(AgentSimulateTest, WritesTheCameraThatItWasGiven) {
  const auto given_path =
      folder.write("given.yaml",
                   "image_width: 320\nimage_height: 240\n"
                   "camera_matrix: {rows: 3, cols: 3, data: [251, 0, 158, 0, 252, 121, 0, 0, 1]}\n"
                   "distortion_coefficients: {rows: 1, cols: 5, data: [0.09, -0.27, 0.001, -0.002, "
                   "0.095]}\n");
  const Finished finished =
      simulate("--part tee=1 --camera " + given_path.string() + " --out " + out("a"));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const auto given = read_camera(given_path);
  const auto written = read_camera(out("a") + "/camera.yaml");
  ASSERT_TRUE(given && written);
  EXPECT_EQ(written->camera.width_px, given->camera.width_px);
  EXPECT_EQ(written->camera.height_px, given->camera.height_px);
  EXPECT_EQ(written->camera.fx_px, given->camera.fx_px);
  EXPECT_EQ(written->camera.fy_px, given->camera.fy_px);
  EXPECT_EQ(written->camera.cx_px, given->camera.cx_px);
  EXPECT_EQ(written->camera.cy_px, given->camera.cy_px);
  EXPECT_EQ(written->camera.distortion, given->camera.distortion);
}

TEST_F(AgentSimulateTest, TheSameSeedMakesTheSameFrames) {
  ASSERT_EQ(simulate("--part tee=2 --seed 7 --out " + out("a")).exit_code, 0);
  ASSERT_EQ(simulate("--part tee=2 --seed 7 --out " + out("b")).exit_code, 0);
  ASSERT_EQ(simulate("--part tee=2 --seed 8 --out " + out("c")).exit_code, 0);
  EXPECT_EQ(bop_frames(out("a"))[0].depth, bop_frames(out("b"))[0].depth);
  EXPECT_NE(bop_frames(out("a"))[0].depth, bop_frames(out("c"))[0].depth);
}

TEST_F(AgentSimulateTest, WrongPartsAreNamed) {
  const Finished no_count = simulate("--part tee --out " + out("a"));
  EXPECT_EQ(no_count.exit_code, 2);
  EXPECT_THAT(no_count.output, AllOf(HasSubstr("--part tee"), HasSubstr("tee=45")));
  EXPECT_EQ(simulate("--part tee=0 --out " + out("a")).exit_code, 2);
  EXPECT_EQ(simulate("--part tee=4x --out " + out("a")).exit_code, 2);
  const Finished unknown = simulate("--part cup=3 --out " + out("a"));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("'cup'"));
}

TEST_F(AgentSimulateTest, ACameraTooCloseToTheBinIsNamed) {
  const Finished finished = simulate("--part tee=1 --camera-height-m 0.3 --out " + out("a"));
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("camera_height_m"));
}

}  // namespace
}  // namespace graspd::testing
