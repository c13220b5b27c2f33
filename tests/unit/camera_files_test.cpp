#include <gmock/gmock.h>

#include "graspd/formats/cell.hpp"
#include "graspd/formats/mirror.hpp"
#include "graspd/types/camera_model.hpp"
#include "temporary_folder.hpp"

namespace graspd {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const CameraIntrinsics kCamera{
    512, 424, 365.5, 366.25, 255.25, 205.5, {0.09, -0.27, 0.001, 0.002, 0.1}};

CameraCalibration some_calibration() {
  CameraCalibration calibration{kCamera, 0.0005, looking_down(), DepthCorrection{}};
  calibration.T_base_camera->translation() << 0.31, 1.0 / 3, 0.95;
  *calibration.depth_correction = {
      {-0.014, 0.1, 0.2, -0.3, 0.4, 0.5}, {0.01, 0, 0, 0, 0, -0.02}, 0.7, 0.5, 0.9};
  return calibration;
}

TEST(CameraFile, IsReadAsItWasWritten) {
  const testing::TemporaryFolder folder;
  const CameraCalibration written = some_calibration();
  ASSERT_TRUE(write_camera(folder.path() / "camera.yaml", written));
  const auto read = read_camera(folder.path() / "camera.yaml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->camera.fy_px, written.camera.fy_px);
  EXPECT_EQ(read->camera.cx_px, written.camera.cx_px);
  EXPECT_EQ(read->camera.distortion, written.camera.distortion);
  EXPECT_EQ(read->depth_scale_m, written.depth_scale_m);
  ASSERT_TRUE(read->T_base_camera);
  EXPECT_EQ(read->T_base_camera->matrix(), written.T_base_camera->matrix());
  ASSERT_TRUE(read->depth_correction);
  EXPECT_EQ(read->depth_correction->offset_m, written.depth_correction->offset_m);
  EXPECT_EQ(read->depth_correction->slope, written.depth_correction->slope);
  EXPECT_EQ(read->depth_correction->max_depth_m, written.depth_correction->max_depth_m);
}

TEST(CameraFile, AWrongDepthCorrectionIsNamed) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_camera(folder.path() / "camera.yaml", some_calibration()));
  std::ifstream file(folder.path() / "camera.yaml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  text.replace(text.find("slope: ["), 8, "slope: [7, ");
  text.replace(text.find("min_depth_m: 0.5"), 16, "min_depth_m: 5.0");
  const auto read = read_camera(folder.write("camera.yaml", text));
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message,
              AllOf(HasSubstr("'slope' must be 6 numbers"), HasSubstr("above 'max_depth_m'")));
}

TEST(CameraFile, AFolderThatIsNotThereIsNamed) {
  const auto written = write_camera("/no/such/folder/camera.yaml", some_calibration());
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("/no/such/folder"));
}

TEST(Mirror, SwapsLeftAndRightInEachRow) {
  std::vector<int> image{1, 2, 3, 4, 5, 6};
  mirror_rows(image, 3);
  EXPECT_THAT(image, ElementsAre(3, 2, 1, 6, 5, 4));
}

TEST(Mirror, AMirroredCameraSeesTheMirroredWorld) {
  const CameraIntrinsics other = mirrored(kCamera);
  EXPECT_EQ(other.cx_px, 511 - kCamera.cx_px);
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.2, 0.1, 0.7), Eigen::Vector3d(-0.3, 0.2, 0.9)}) {
    const Eigen::Vector2d seen = project(kCamera, p);
    const Eigen::Vector2d mirrored_px = project(other, {-p.x(), p.y(), p.z()});
    EXPECT_NEAR(mirrored_px.x(), 511 - seen.x(), 1e-9);
    EXPECT_NEAR(mirrored_px.y(), seen.y(), 1e-9);
  }
  EXPECT_EQ(mirrored(other).distortion, kCamera.distortion);
}

TEST(DepthCorrector, MovesReadingsAndLeavesEmptyPixelsEmpty) {
  DepthCorrection correction{{-0.01, 0, 0, 0, 0, 0}, {0.1, 0, 0, 0, 0, 0}, 0.7, 0.5, 0.9};
  DepthFrame frame{{4, 1, 4, 4, 2, 0, {}}, 0.001, {0, 600, 900, 2000}};
  DepthCorrector(correction, frame.camera).correct(frame);
  EXPECT_THAT(frame.depth, ElementsAre(0, 580, 910, 2010));
}

}  // namespace
}  // namespace graspd
