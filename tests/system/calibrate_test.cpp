#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "board_scene.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/formats/depth_image.hpp"
#include "graspd/formats/mirror.hpp"
#include "serve_process.hpp"
#include "temporary_folder.hpp"

/// `robot_agent calibrate`, on a folder of images as a Kinect v2 delivers them: mirrored, infrared
/// in 16 bits.
namespace graspd::testing {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

const calibration::Board kBoard{7, 5, 0.04, 0.03, "DICT_4X4_50", 0.02};
/// Of the images once mirrored back.
const CameraIntrinsics kCamera{512, 424, 365.5, 365.5, 256, 205, {0.0905, -0.268, 0, 0, 0.095}};
constexpr double kTooFar_m = 0.012;

std::string numbers(const Isometry3d& T) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = T.matrix();
  return fmt::format("[{}]", fmt::join(rows.data(), rows.data() + 16, ", "));
}

class CalibrateTest : public ::testing::Test {
 protected:
  CalibrateTest() {
    T_base_camera.translation() << 0.31, 0.02, 0.95;
    T_flange_board.translation() << 0.1, 0.08, 0.03;
    EXPECT_TRUE(write_camera(folder.path() / "kinect.yaml",
                             {mirrored(kCamera), 0.001, Isometry3d::Identity(), {}}));
  }

  /// Ten views, tilted about both axes, at 0.55 to 0.75 m.
  void record_views() {
    std::string views;
    for (int i = 0; i < 10; ++i) {
      const double angle = 2 * M_PI * i / 10;
      const Vector3d turn_rad(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.1 * i - 0.5);
      const Isometry3d T_camera_board =
          facing(kBoard, {0.05 * std::sin(3 * angle), 0.04 * std::cos(2 * angle)}, 0.55 + 0.02 * i,
                 turn_rad);
      write_images(i, {kBoard, kCamera, T_camera_board});
      views += fmt::format("  - {{image: ir_{}.png, depth: depth_{}.png, T_base_flange: {}}}\n", i,
                           i, numbers(T_base_camera * T_camera_board * T_flange_board.inverse()));
    }
    write_poses("{columns_n: 7, rows_n: 5, square_m: 0.04, marker_m: 0.03, margin_m: 0.02}", views);
  }

  void write_images(int i, const BoardScene& scene) {
    auto seen = see_board(scene, 4, static_cast<std::uint64_t>(i));
    mirror_rows(seen.values, seen.width_px);
    Image16 infrared{seen.width_px, seen.height_px, {}};
    for (const std::uint8_t grey : seen.values) {
      infrared.values.push_back(static_cast<std::uint16_t>(grey * 40));
    }
    auto read = read_plate(scene, 0.0013, static_cast<std::uint64_t>(i),
                           [](const Vector3d&, double) { return kTooFar_m; });
    mirror_rows(read.depth, read.camera.width_px);
    ASSERT_TRUE(write_png16(folder.path() / fmt::format("ir_{}.png", i), infrared));
    ASSERT_TRUE(write_png16(folder.path() / fmt::format("depth_{}.png", i),
                            {read.camera.width_px, read.camera.height_px, read.depth}));
  }

  void write_poses(const std::string& board, const std::string& views, bool is_mirrored = true) {
    folder.write("poses.yaml",
                 fmt::format("board: {}\nmirrored: {}\nviews:\n{}", board, is_mirrored, views));
  }

  /// The example of its --help, where what that names is.
  Finished calibrate() const {
    return run(
        fmt::format("cd {} && ln -sfn . board && eval \"$({} --print-examples |"
                    " sed -n 's|^robot_agent calibrate: robot_agent|{}|p')\"",
                    folder.path().string(), ROBOT_AGENT, ROBOT_AGENT));
  }

  Isometry3d T_base_camera = looking_down();
  Isometry3d T_flange_board = looking_down();
  TemporaryFolder folder;
};

TEST_F(CalibrateTest, WritesWhereTheCameraStandsAndWhatItsDepthIsOffBy) {
  record_views();
  const Finished finished = calibrate();
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("camera pose from 10 views: held out"),
                                     HasSubstr("depth correction from 10 views")));
  const auto camera = read_camera(folder.path() / "camera.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->camera.cx_px, kCamera.cx_px);  // of images mirrored back
  const Vector3d p_camera(0.05, 0.05, 0.7);
  EXPECT_LT((*camera->T_base_camera * p_camera - T_base_camera * p_camera).norm(), 0.0015);
  ASSERT_TRUE(camera->depth_correction);
  DepthFrame frame{kCamera, 0.001, std::vector<std::uint16_t>(512 * 424, 650)};
  DepthCorrector(*camera->depth_correction, kCamera).correct(frame);
  EXPECT_NEAR(frame.at(256, 205), 638, 1);
}

TEST_F(CalibrateTest, ViewsWithoutABoardAreNamed) {
  BoardScene elsewhere{kBoard, kCamera, facing(kBoard, {5, 0}, 0.6, {0, 0, 0})};
  write_images(0, elsewhere);
  write_poses("{columns_n: 7, rows_n: 5, square_m: 0.04, marker_m: 0.03}",
              "  - {image: ir_0.png, T_base_flange: " + numbers(T_base_camera) + "}\n");
  const Finished finished = calibrate();
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("no view shows the board"), HasSubstr("ir_0.png"),
                                     HasSubstr("no marker of DICT_4X4_50")));
}

TEST_F(CalibrateTest, WhatIsWrongInThePosesIsNamedTogether) {
  write_poses("{columns_n: 7, rows_n: 5, square: 0.04, marker_m: 0.03}",
              "  - {T_base_flange: [1, 2, 3]}\n");
  const Finished finished = calibrate();
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("poses.yaml:1: unknown key 'square'"),
                                     HasSubstr("'square_m' is missing"),
                                     HasSubstr("'image' is missing"), HasSubstr("poses.yaml:4")));
}

TEST_F(CalibrateTest, AnImageOfAnotherSizeIsNamed) {
  ASSERT_TRUE(write_png16(folder.path() / "ir_0.png", {4, 2, std::vector<std::uint16_t>(8, 9)}));
  write_poses("{columns_n: 7, rows_n: 5, square_m: 0.04, marker_m: 0.03}",
              "  - {image: ir_0.png}\n");
  const Finished finished = calibrate();
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, AllOf(HasSubstr("ir_0.png: 4 × 2 pixels"), HasSubstr("512 × 424")));
}

}  // namespace
}  // namespace graspd::testing
