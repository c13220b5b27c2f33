#include "graspd/formats/bop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "random_pose.hpp"
#include "temporary_folder.hpp"

namespace graspd {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

BopImage random_image(int im_id, std::mt19937& random) {
  const auto random_pose = [&] {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.rotate(testing::random_rotation(random));
    T.translation() = testing::random_point(random, 1).cast<double>();
    return T;
  };
  BopImage image;
  image.im_id = im_id;
  image.frame.camera = {64, 48, 60.5, 61.5, 31, 23, {0.1, -0.2, 0.001, 0.002, 0.05}};
  image.frame.depth_scale_m = 0.0005;
  image.instance = Image16{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) {
    image.frame.depth.push_back(static_cast<std::uint16_t>(random()));
    image.instance->values.push_back(static_cast<std::uint16_t>(random() % 4));
  }
  image.bin = BopBin{random_pose(), {0.3, 0.2, 0.1}};
  image.T_world_camera = random_pose();
  for (int i = 0; i < 3; ++i) image.truth.push_back({i + 1, random_pose(), 0.25 * i});
  return image;
}

TEST(BopScene, WritesWhatItReads) {
  std::mt19937 random(9);
  const testing::TemporaryFolder folder;
  const auto directory = folder.path() / "000042";
  BopSceneWriter writer(directory);
  const BopImage images[] = {random_image(0, random), random_image(17, random)};
  for (const BopImage& image : images) ASSERT_TRUE(writer.add(image));
  ASSERT_TRUE(writer.finish());

  const auto scene = BopScene::open(directory);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->scene_id(), 42);
  EXPECT_EQ(scene->image_ids(), (std::vector<int>{0, 17}));
  for (const BopImage& image : images) {
    const auto read = scene->read(image.im_id);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->frame.depth, image.frame.depth);
    EXPECT_EQ(read->frame.camera.fx_px, image.frame.camera.fx_px);
    EXPECT_EQ(read->frame.camera.cy_px, image.frame.camera.cy_px);
    EXPECT_EQ(read->frame.camera.distortion, image.frame.camera.distortion);
    EXPECT_NEAR(read->frame.depth_scale_m, image.frame.depth_scale_m, 1e-12);
    ASSERT_TRUE(read->bin);
    EXPECT_TRUE(read->bin->T_camera_bin.isApprox(image.bin->T_camera_bin, 1e-9));
    EXPECT_TRUE(read->bin->inner_size_m.isApprox(image.bin->inner_size_m));
    ASSERT_TRUE(read->T_world_camera);
    EXPECT_TRUE(read->T_world_camera->isApprox(*image.T_world_camera, 1e-9));
    ASSERT_EQ(read->truth.size(), image.truth.size());
    for (std::size_t i = 0; i < image.truth.size(); ++i) {
      EXPECT_EQ(read->truth[i].obj_id, image.truth[i].obj_id);
      EXPECT_TRUE(read->truth[i].T_camera_part.isApprox(image.truth[i].T_camera_part, 1e-9));
      EXPECT_EQ(read->truth[i].visible_fraction, image.truth[i].visible_fraction);
    }
    ASSERT_TRUE(read->instance);
    EXPECT_EQ(read->instance->values, image.instance->values);
  }
}

std::string refusal(const std::filesystem::path& directory) {
  const auto scene = BopScene::open(directory);
  if (!scene) return scene.error().message;
  const auto image = scene->read(scene->image_ids().front());
  return image ? "" : image.error().message;
}

TEST(BopScene, NamesWhatIsWrong) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(refusal(folder.path() / "none"), HasSubstr("scene_camera.json: can't be read"));
  folder.write("scene_camera.json", "{\"0\": ");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("not as BOP has it"));
  folder.write("scene_camera.json", "{}");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("no image in it"));
  folder.write("scene_camera.json", R"({"0": {"depth_scale": 1.0}})");
  EXPECT_THAT(refusal(folder.path()), AllOf(HasSubstr("image 0"), HasSubstr("cam_K")));
  folder.write("scene_camera.json", R"({"0": {"cam_K": [1, 2, 3]}})");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("3 numbers instead of 9"));
  folder.write("scene_camera.json", R"({"0": {"cam_K": [9, 0, 4, 0, 9, 4, 0, 0, 1]}})");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("000000.png: no such file"));
  folder.write("depth/000000.png", "this is no image");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("000000.png: damaged, or not an image"));
}

TEST(BopResults, AreWrittenInMillimetresAndSeconds) {
  const testing::TemporaryFolder folder;
  BopResult result{3, 7, 2, 0.875, Eigen::Isometry3d::Identity(), 0.0425};
  result.T_camera_part.translation() = Eigen::Vector3d(0.001, -0.002, 0.75);
  const auto path = folder.path() / "results.csv";
  ASSERT_TRUE(write_bop_results(path, {result}));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(),
            "scene_id,im_id,obj_id,score,R,t,time\n"
            "3,7,2,0.875000,1.000000000 0.000000000 0.000000000 0.000000000 1.000000000 "
            "0.000000000 0.000000000 0.000000000 1.000000000,1.000000 -2.000000 750.000000,"
            "0.042500\n");
  EXPECT_FALSE(write_bop_results(folder.path() / "none" / "results.csv", {result}));
}

}  // namespace
}  // namespace graspd
