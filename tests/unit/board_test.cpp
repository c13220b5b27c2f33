#include "graspd/calibration/board.hpp"

#include <gmock/gmock.h>

#include "board_scene.hpp"
#include "graspd/formats/depth_image.hpp"
#include "graspd/formats/mirror.hpp"
#include "graspd/types/camera_model.hpp"
#include "temporary_folder.hpp"

namespace graspd::calibration {
namespace {

using ::testing::HasSubstr;
using testing::kKinect;

const Board kBoard{7, 5, 0.04, 0.03, "DICT_4X4_50", 0.02};

testing::BoardScene scene_at(double distance_m, const Eigen::Vector3d& turn_rad) {
  return {kBoard, kKinect, testing::facing(kBoard, {0.02, -0.01}, distance_m, turn_rad)};
}

std::string fault_of(const GrayImage& image, const Board& board = kBoard) {
  const auto view = find_board(image, board, kKinect);
  EXPECT_FALSE(view);
  return view ? "" : view.error().message;
}

TEST(Board, CornersAndPoseAreThoseOfTheTruth) {
  for (const double distance_m : {0.5, 0.7, 0.9}) {
    const auto scene = scene_at(distance_m, {0.3, -0.4, 0.5});
    const auto view = find_board(testing::see_board(scene, 4, 1), kBoard, kKinect);
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_EQ(view->p_px.size(), 24U);
    double sum_px2 = 0;
    for (std::size_t i = 0; i < view->p_px.size(); ++i) {
      const auto true_px = project(kKinect, scene.T_camera_board * view->p_board_m[i]);
      sum_px2 += (view->p_px[i] - true_px).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum_px2 / 24), 0.2) << distance_m;
    const Eigen::Isometry3d off = scene.T_camera_board.inverse() * view->T_camera_board;
    EXPECT_LT(off.translation().norm(), 0.004) << distance_m;
    EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 0.02) << distance_m;
  }
}

TEST(Board, ABoardThatIsSeenInPartIsFound) {
  auto scene = scene_at(0.6, {0.2, 0.2, 0});
  scene.T_camera_board.pretranslate(Eigen::Vector3d(0.35, 0, 0));
  const auto view = find_board(testing::see_board(scene, 4, 1), kBoard, kKinect);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_LT(view->p_px.size(), 24U);
}

TEST(Board, NoBoardIsSaid) {
  auto scene = scene_at(0.6, {0, 0, 0});
  scene.T_camera_board.pretranslate(Eigen::Vector3d(2, 0, 0));
  EXPECT_THAT(fault_of(testing::see_board(scene, 4, 1)), HasSubstr("no marker of DICT_4X4_50"));
}

TEST(Board, AMirroredImageIsSaid) {
  GrayImage image = testing::see_board(scene_at(0.6, {0.1, 0.2, 0.3}), 4, 1);
  mirror_rows(image.values, image.width_px);
  EXPECT_THAT(fault_of(image), HasSubstr("mirrored"));
}

TEST(Board, ABoardOfOtherSquaresIsSaid) {
  const GrayImage image = testing::see_board(scene_at(0.6, {0.1, 0.2, 0.3}), 4, 1);
  Board other = kBoard;
  other.columns_n = 9;
  EXPECT_THAT(fault_of(image, other), HasSubstr("9 × 5 squares"));
}

TEST(Board, WhatCanBeNoBoardIsRefused) {
  const GrayImage image = testing::see_board(scene_at(0.6, {0, 0, 0}), 4, 1);
  Board wrong = kBoard;
  wrong.dictionary = "DICT_9X9";
  EXPECT_THAT(fault_of(image, wrong), HasSubstr("no dictionary 'DICT_9X9'; known: DICT_4X4_100"));
  wrong = kBoard;
  wrong.marker_m = 0.05;
  EXPECT_THAT(fault_of(image, wrong), HasSubstr("smaller than its square"));
  wrong = kBoard;
  wrong.rows_n = 1;
  EXPECT_THAT(fault_of(image, wrong), HasSubstr("at least 3 × 3"));
  wrong = kBoard;
  wrong.columns_n = wrong.rows_n = 12;
  EXPECT_THAT(fault_of(image, wrong), HasSubstr("more than DICT_4X4_50 holds"));
}

TEST(Board, AnInfraredImageOf16BitsIsReadAndMirroredBack) {
  const testing::TemporaryFolder folder;
  Image16 infrared{4, 1, {0, 1000, 2000, 4000}};
  ASSERT_TRUE(write_png16(folder.path() / "ir.png", infrared));
  const auto image = read_gray_image(folder.path() / "ir.png", true);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_THAT(image->values, ::testing::ElementsAre(255, 128, 64, 0));
  const auto missing = read_gray_image(folder.path() / "no.png", false);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("no.png"));
}

}  // namespace
}  // namespace graspd::calibration
