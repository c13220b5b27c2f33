#include <gmock/gmock.h>

#include <map>

#include "graspd/recordings/rawlog.hpp"
#include "graspd/sim_cell/scene_folder.hpp"
#include "graspd/simulation/render.hpp"
#include "temporary_folder.hpp"

namespace graspd::sim_cell {
namespace {

using ::testing::HasSubstr;

class SimSceneTest : public ::testing::Test {
 protected:
  SimSceneTest() {
    auto loaded = parts::Catalogue::load(std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/parts");
    if (!loaded) throw std::runtime_error(loaded.error().message);
    catalogue = *std::move(loaded);
    options.parts = {{"tee", 5}, {"l_bracket", 4}};
    options.frames_n = 3;
    options.seed = 7;
  }

  Result<SceneReport> simulate() const { return simulate_scene(catalogue, options, scene_path); }

  std::string error() const {
    const auto report = simulate();
    return report ? "no error" : report.error().message;
  }

  parts::Catalogue catalogue;
  simulation::SceneOptions options;
  testing::TemporaryFolder folder;
  std::filesystem::path scene_path = folder.path() / "000001";
};

void expect_equal(const DepthFrame& a, const DepthFrame& b) {
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.depth_scale_m, b.depth_scale_m);
  EXPECT_EQ(a.camera.fx_px, b.camera.fx_px);
  EXPECT_EQ(a.camera.cy_px, b.camera.cy_px);
  EXPECT_EQ(a.camera.distortion, b.camera.distortion);
}

TEST_F(SimSceneTest, BopSceneAndRawlogHoldWhatWasMade) {
  options.sensor.camera.distortion = {0.0905, -0.268, 0.001, 0, 0.095};
  std::vector<int> progress;
  const auto report = simulate_scene(catalogue, options, scene_path,
                                     [&](int frame_n) { progress.push_back(frame_n); });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(progress, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(report->frames_n, 3);
  EXPECT_EQ(report->parts_n, 27);

  const auto maker = simulation::SceneMaker::create(catalogue, options);
  const auto scene = BopScene::open(scene_path);
  auto rawlog = RawlogReader::open(scene_path / "frames.rawlog");
  ASSERT_TRUE(maker && scene && rawlog);
  EXPECT_EQ(scene->image_ids(), (std::vector<int>{0, 1, 2}));
  for (int k = 0; k < options.frames_n; ++k) {
    const auto made = maker->make(k);
    const auto image = scene->read(k);
    const auto recorded = rawlog->next();
    ASSERT_TRUE(made && image && recorded && *recorded);
    expect_equal(image->frame, made->frame);
    expect_equal((*recorded)->frame, made->frame);
    ASSERT_TRUE(image->bin && image->instance);
    EXPECT_EQ(image->instance->values, made->instance->values);
    EXPECT_TRUE(image->bin->T_camera_bin.isApprox(made->bin->T_camera_bin, 1e-9));
    EXPECT_TRUE(image->bin->inner_size_m.isApprox(options.bin_inner_size_m, 1e-9));
    ASSERT_EQ(image->truth.size(), made->truth.size());
    for (std::size_t i = 0; i < made->truth.size(); ++i) {
      EXPECT_EQ(image->truth[i].obj_id, made->truth[i].obj_id);
      EXPECT_TRUE(image->truth[i].T_camera_part.isApprox(made->truth[i].T_camera_part, 1e-6));
      EXPECT_NEAR(image->truth[i].visible_fraction, made->truth[i].visible_fraction, 1e-9);
    }
  }
  EXPECT_FALSE(*rawlog->next()) << "no frame after the last one";
}

TEST_F(SimSceneTest, TheTruthIsTheSceneThatIsSeen) {
  const auto maker = simulation::SceneMaker::create(catalogue, options);
  ASSERT_TRUE(maker);
  const auto image = maker->make(0);
  ASSERT_TRUE(image) << image.error().message;
  // The parts alone, drawn from the poses that the scene says: where the instance image has a part,
  // no part is nearer, and the frame reads its depth up to the sensor's errors.
  std::vector<simulation::SceneObject> objects;
  for (const BopTruth& truth : image->truth) {
    objects.push_back({&catalogue.find_bop(truth.obj_id)->mesh, truth.T_camera_part});
  }
  const simulation::Rendering drawn = simulation::render(image->frame.camera, objects);
  std::vector<double> errors_mm;
  std::map<int, int> pixels_n;
  for (std::size_t i = 0; i < image->instance->values.size(); ++i) {
    const int id = image->instance->values[i];
    if (id == 0) continue;
    EXPECT_EQ(drawn.object[i], id - 1);
    ++pixels_n[id];
    if (image->frame.depth[i] > 0) {
      errors_mm.push_back(std::abs(image->frame.depth[i] - 1e3 * double(drawn.z_m[i])));
    }
  }
  ASSERT_GT(errors_mm.size(), 1000u);
  std::sort(errors_mm.begin(), errors_mm.end());
  EXPECT_LT(errors_mm[errors_mm.size() / 2], 6);
  for (std::size_t i = 0; i < image->truth.size(); ++i) {
    EXPECT_EQ(image->truth[i].visible_fraction > 0, pixels_n.contains(int(i) + 1)) << i;
    EXPECT_GE(image->truth[i].visible_fraction, 0);
    EXPECT_LE(image->truth[i].visible_fraction, 1);
  }
}

TEST_F(SimSceneTest, TheCameraLooksAtTheBinsCentreFromItsHeight) {
  options.camera_tilt_rad = 0.3;
  options.camera_height_m = 0.9;
  options.parts = {};
  const auto maker = simulation::SceneMaker::create(catalogue, options);
  ASSERT_TRUE(maker);
  const auto image = maker->make(0);
  ASSERT_TRUE(image);
  EXPECT_TRUE(image->bin->T_camera_bin.translation().isApprox(Eigen::Vector3d(0, 0, 0.9), 1e-9));
  const Eigen::Vector3d up = image->bin->T_camera_bin.linear().col(2);
  EXPECT_NEAR(up.z(), -std::cos(0.3), 1e-9);
  EXPECT_NEAR(image->frame.at(255, 205), 900, 15);
}

TEST_F(SimSceneTest, AFrameDependsOnItsOwnSeedOnly) {
  const auto maker = simulation::SceneMaker::create(catalogue, options);
  simulation::SceneOptions later = options;
  later.seed = options.seed + 2;
  const auto later_maker = simulation::SceneMaker::create(catalogue, later);
  ASSERT_TRUE(maker && later_maker);
  const auto third = maker->make(2);
  ASSERT_TRUE(third);
  EXPECT_EQ(third->frame.depth, later_maker->make(0)->frame.depth);
  EXPECT_NE(third->frame.depth, maker->make(0)->frame.depth);
}

TEST_F(SimSceneTest, WrongOptionsAreNamed) {
  options.parts = {{"cup", 3}};
  EXPECT_THAT(error(), HasSubstr("'cup'"));
  EXPECT_EQ(simulate().error().code, Code::kUnknownPart);
  options.parts = {{"tee", -3}};
  EXPECT_THAT(error(), HasSubstr("-3 parts"));
  options.parts = {{"tee", 1}};
  options.camera_height_m = 0.4;
  EXPECT_THAT(error(), HasSubstr("camera_height_m"));
  options.camera_height_m = 0.75;
  options.bin_inner_size_m.x() = 0;
  EXPECT_THAT(error(), HasSubstr("bin_inner_size_m"));
  options.bin_inner_size_m.x() = 0.3;
  options.sensor.camera.fx_px = 0;
  EXPECT_THAT(error(), HasSubstr("fx"));
}

TEST_F(SimSceneTest, AFileWhereTheFolderShouldBeIsNamed) {
  folder.write("000001", "a file");
  options.parts = {};
  EXPECT_THAT(error(), HasSubstr(scene_path.string()));
}

}  // namespace
}  // namespace graspd::sim_cell
