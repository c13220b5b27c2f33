#include "graspd/calibration/depth_fit.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "board_scene.hpp"

namespace graspd::calibration {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A plate that fills most of the image.
const Board kPlate{7, 5, 0.06, 0.045, "DICT_4X4_50", 0.06};
const CameraIntrinsics kCamera{
    256, 212, 182.75, 182.75, 127.25, 102.25, {0.0905, -0.268, 0, 0, 0.095}};
constexpr double kNoise_m = 0.0013;

/// As a Kinect v2 is off: a device offset, more towards the corners, waves along the depth. It is
/// none of the correction's own terms.
double off_m(const Vector3d& ray, double z_m) {
  return 0.014 + 0.02 * ray.head<2>().squaredNorm() + 0.002 * std::sin(z_m * 6) +
         0.004 * ray.x() * z_m;
}

DepthView view_at(double distance_m, const Vector3d& turn_rad, std::uint64_t seed) {
  const testing::BoardScene scene{kPlate, kCamera,
                                  testing::facing(kPlate, {0, 0}, distance_m, turn_rad)};
  return {fmt::format("{:.2f} m", distance_m), testing::read_plate(scene, kNoise_m, seed, off_m),
          scene.T_camera_board};
}

std::vector<DepthView> some_views() {
  std::vector<DepthView> views;
  std::uint64_t seed = 0;
  for (const double distance_m : {0.55, 0.62, 0.7, 0.78, 0.85}) {
    views.push_back(view_at(distance_m, {0.1, -0.1, 0.1}, ++seed));
  }
  return views;
}

TEST(DepthFit, WhatIsLeftOnAHeldOutViewIsTheNoise) {
  const auto fit = fit_depth_correction(some_views(), kPlate, kCamera);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_GT(fit->bias_before_m, 0.014);
  EXPECT_LT(fit->before.mean_m, -0.014);  // it reads too far
  EXPECT_LT(fit->bias_held_out_m, 0.0007);
  EXPECT_LT(std::abs(fit->held_out.mean_m), 0.0003);
  EXPECT_NEAR(fit->held_out.rms_m, kNoise_m, 0.0003);
  EXPECT_GT(fit->image_share, 0.4);
}

TEST(DepthFit, TheCorrectionMakesAnotherFrameTrue) {
  const auto fit = fit_depth_correction(some_views(), kPlate, kCamera);
  ASSERT_TRUE(fit);
  const testing::BoardScene scene{kPlate, kCamera,
                                  testing::facing(kPlate, {0, 0}, 0.66, {0, 0.15, 0})};
  const DepthFrame truth =
      testing::read_plate(scene, 0, 1, [](const Vector3d&, double) { return 0.0; });
  DepthFrame corrected = testing::read_plate(scene, 0, 1, off_m);
  DepthCorrector(fit->correction, kCamera).correct(corrected);
  int worst_mm = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    if (truth.depth[i] == 0) {
      EXPECT_EQ(corrected.depth[i], 0);
    } else {
      worst_mm = std::max(worst_mm, std::abs(truth.depth[i] - corrected.depth[i]));
    }
  }
  EXPECT_LE(worst_mm, 2);
}

TEST(DepthFit, BeyondTheDepthsItSawItStaysAsItIsThere) {
  const auto fit = fit_depth_correction(some_views(), kPlate, kCamera);
  ASSERT_TRUE(fit);
  const DepthCorrector corrector(fit->correction, kCamera);
  const auto moved_mm = [&](std::uint16_t depth_mm) {
    const auto pixels_n = static_cast<std::size_t>(kCamera.width_px * kCamera.height_px);
    DepthFrame frame{kCamera, 0.001, std::vector<std::uint16_t>(pixels_n, depth_mm)};
    corrector.correct(frame);
    return frame.at(0, 0) - depth_mm;
  };
  EXPECT_EQ(moved_mm(4000),
            moved_mm(static_cast<std::uint16_t>(std::ceil(fit->correction.max_depth_m * 1e3))));
}

TEST(DepthFit, AtOneDistanceTheOffsetIsFoundAll) {
  std::vector<DepthView> views;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) views.push_back(view_at(0.7, {0, 0, 0}, seed));
  const auto fit = fit_depth_correction(views, kPlate, kCamera);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LT(fit->bias_held_out_m, 0.0007);
}

TEST(DepthFit, WhereThePlateHasAMarginPrintIsNotRead) {
  const auto views = some_views();
  Board no_margin = kPlate;
  no_margin.margin_m = 0;
  const auto with = fit_depth_correction(views, kPlate, kCamera);
  const auto without = fit_depth_correction(views, no_margin, kCamera);
  ASSERT_TRUE(with && without);
  const double plate_m2 = 0.54 * 0.42;
  const double print_m2 = 0.42 * 0.30;
  EXPECT_NEAR(static_cast<double>(with->readings_n) / static_cast<double>(without->readings_n),
              (plate_m2 - print_m2) / print_m2, 0.15);
}

TEST(DepthFit, WrongInputIsRefused) {
  const auto fault_of = [](const std::vector<DepthView>& views) {
    const auto fit = fit_depth_correction(views, kPlate, kCamera);
    EXPECT_FALSE(fit);
    return fit ? "" : fit.error().message;
  };
  auto views = some_views();
  EXPECT_THAT(fault_of({views.begin(), views.begin() + 2}),
              AllOf(HasSubstr("2 views"), HasSubstr("at least 3")));
  views[1].depth.depth.assign(views[1].depth.depth.size(), 0);
  EXPECT_THAT(fault_of(views), AllOf(HasSubstr("0.62 m"), HasSubstr("0 depth readings")));
  views = some_views();
  views[2].depth.camera.width_px = 512;
  EXPECT_THAT(fault_of(views), AllOf(HasSubstr("0.70 m"), HasSubstr("512 × 212")));
}

}  // namespace
}  // namespace graspd::calibration
