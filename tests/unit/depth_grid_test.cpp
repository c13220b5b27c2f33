#include "graspd/perception/depth_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "block_scene.hpp"
#include "graspd/perception/preprocess.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kFloor_m = 0.75;

PreprocessParameters without_stray_light() {
  PreprocessParameters parameters;
  parameters.stray_light_share = 0;
  return parameters;
}

/// A block with its top face 50 mm above the floor.
std::vector<testing::Block> one_block() {
  testing::Block block;
  block.T_camera_block.translation() = Vector3d(0.03, -0.02, kFloor_m - 0.03);
  block.size_m = Vector3d(0.08, 0.06, 0.04);
  return {block};
}

Cloud above_floor(const DepthFrame& frame) {
  Cloud cloud = unproject(frame, without_stray_light());
  std::erase_if(cloud.points_m, [](const Vector3f& p) { return p.z() > kFloor_m - 0.01; });
  return cloud;
}

TEST(DepthGrid, IsThePinholeImageOfTheReadings) {
  CameraIntrinsics camera = testing::kinect_v2();
  camera.distortion = {0.09, -0.27, 0.001, -0.002, 0.1};  // a Kinect v2's
  const DepthFrame frame = testing::render(camera, kFloor_m, one_block());
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), without_stray_light());
  int top_n = 0;
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      const Vector3f p = grid.point_m(u, v);
      // Half a pixel within the face, which is a millimetre.
      if (std::abs(p.x() - 0.03F) > 0.038F || std::abs(p.y() + 0.02F) > 0.028F) continue;
      EXPECT_NEAR(p.z(), kFloor_m - 0.05, 0.0006) << u << ", " << v;
      EXPECT_EQ(grid.cell_of(p), grid.index(u, v));
      EXPECT_EQ(grid.is_part[grid.index(u, v)], 1);
      ++top_n;
    }
  }
  EXPECT_GT(top_n, 900) << "80 × 60 mm at about 1.9 mm a pixel";
}

TEST(DepthGrid, HasAMarginAndNothingOutermost) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloor_m, one_block());
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), without_stray_light());
  for (int v = 0; v < grid.height_px; ++v) {
    for (int u = 0; u < grid.width_px; ++u) {
      if (grid.contains(u, v)) continue;
      EXPECT_EQ(grid.packed[grid.index(u, v)], 0U);
    }
  }
  EXPECT_EQ(grid.is_part[grid.index(3, 3)], 0) << "floor";
  EXPECT_GT(grid.z_m[grid.index(3, 3)], 0) << "which refutes what reaches beyond the parts";
}

TEST(DepthGrid, NormalsAreThoseOfTheFaces) {
  auto blocks = one_block();
  blocks[0].T_camera_block.rotate(Eigen::AngleAxisd(0.5, Vector3d::UnitY()));
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloor_m, blocks);
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), without_stray_light());
  const Vector3f centre =
      (blocks[0].T_camera_block * Vector3d(0, 0, -0.02)).cast<float>();  // of the face on top
  const Vector3f normal = -blocks[0].T_camera_block.linear().col(2).cast<float>();
  EXPECT_GT(grid.normals[grid.cell_of(centre)].dot(normal), std::cos(0.05));
}

TEST(DepthGrid, WhatIsClaimedHidesAndRefutesNothing) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloor_m, one_block());
  DepthGrid grid = make_depth_grid(frame, above_floor(frame), without_stray_light());
  const std::size_t cell = grid.cell_of({0.03F, -0.02F, 0.70F});
  const float z_m = grid.z_m[cell];
  EXPECT_TRUE(grid.is_open(cell));
  const std::vector<float> padded(17, 0);
  const auto counts_at = [&](std::size_t at, float depth_m) {
    const auto width = static_cast<std::size_t>(grid.width_px);
    const std::size_t u = at % width, v = at / width;
    const Vector3f p = depth_m * Vector3f((static_cast<float>(u) - grid.cx_px) / grid.fx_px,
                                          (static_cast<float>(v) - grid.cy_px) / grid.fy_px, 1);
    const KernelPose pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {p.x(), p.y(), p.z()}};
    return count_evidence(grid.for_kernel(), pose, {padded.data(), padded.data(), padded.data(), 1},
                          0.006F);
  };
  EXPECT_EQ(counts_at(cell, z_m).support_n, 1);
  EXPECT_EQ(counts_at(cell + 1, z_m - 0.1F).refute_n, 1);
  grid.claim({cell});
  EXPECT_FALSE(grid.is_open(cell));
  EXPECT_EQ(counts_at(cell, z_m).support_n, 0);
  EXPECT_EQ(counts_at(cell, z_m).hidden_n, 1);
  EXPECT_EQ(counts_at(cell + 1, z_m).support_n, 1) << "its neighbour still speaks for a pose";
  EXPECT_EQ(counts_at(cell + 1, z_m - 0.1F).refute_n, 0) << "but, at its edge, against none";
}

/// The sensor's side: each reading becomes the mean of its own light and of its surroundings'.
std::vector<float> with_stray_light(const std::vector<float>& z_m, int width, int height,
                                    double share, double sigma_px) {
  const int reach = static_cast<int>(3 * sigma_px);
  std::vector<double> light(z_m.size()), light_z(z_m.size());
  for (std::size_t i = 0; i < z_m.size(); ++i) {
    light[i] = 1 / (double(z_m[i]) * double(z_m[i]));
    light_z[i] = light[i] * double(z_m[i]);
  }
  const auto blurred = [&](std::vector<double> image) {
    for (const int step : {1, width}) {
      std::vector<double> result(image.size(), 0);
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
          const int at = step == 1 ? u : v;
          const int last = (step == 1 ? width : height) - 1;
          double total = 0;
          for (int k = -reach; k <= reach; ++k)
            total += std::exp(-0.5 * k * k / (sigma_px * sigma_px));
          for (int k = std::max(-reach, -at); k <= std::min(reach, last - at); ++k) {
            result[std::size_t(v * width + u)] += std::exp(-0.5 * k * k / (sigma_px * sigma_px)) /
                                                  total *
                                                  image[std::size_t(v * width + u + k * step)];
          }
        }
      }
      image = std::move(result);
    }
    return image;
  };
  const auto around = blurred(light), around_z = blurred(light_z);
  std::vector<float> read(z_m.size());
  for (std::size_t i = 0; i < z_m.size(); ++i) {
    read[i] = float((light_z[i] + share * around_z[i]) / (light[i] + share * around[i]));
  }
  return read;
}

TEST(StrayLight, IsTakenOutOfAPileOfFlatSteps) {
  constexpr int kWidth = 160, kHeight = 120;
  PreprocessParameters parameters;
  parameters.stray_light_share = 0.2;
  parameters.stray_light_sigma_px = 16;
  std::vector<float> truth(std::size_t(kWidth * kHeight), 0.75F);
  for (int v = 30; v < 90; ++v) {
    for (int u = 40; u < 110; ++u) truth[std::size_t(v * kWidth + u)] = u < 75 ? 0.70F : 0.66F;
  }
  const auto read = with_stray_light(truth, kWidth, kHeight, 0.2, 16);
  std::vector<float> mended = read;
  remove_stray_light(parameters, kWidth, kHeight, 365, mended);
  double worst_before_m = 0, worst_after_m = 0;
  for (int v = 36; v < 84; v += 6) {
    for (const int u : {46, 58, 69, 82, 94, 104}) {  // on the steps, not at their edges
      const std::size_t i = std::size_t(v * kWidth + u);
      worst_before_m = std::max(worst_before_m, std::abs(double(read[i]) - double(truth[i])));
      worst_after_m = std::max(worst_after_m, std::abs(double(mended[i]) - double(truth[i])));
    }
  }
  EXPECT_GT(worst_before_m, 0.005) << "else there is nothing to mend";
  EXPECT_LT(worst_after_m, 0.0015);
}

TEST(StrayLight, LeavesAFlatFloorAndMissingReadings) {
  std::vector<float> z_m(100 * 80, 0.8F);
  z_m[4050] = 0;
  PreprocessParameters parameters;
  remove_stray_light(parameters, 100, 80, 365, z_m);
  for (std::size_t i = 0; i < z_m.size(); ++i) EXPECT_NEAR(z_m[i], i == 4050 ? 0 : 0.8, 1e-4);
}

}  // namespace
}  // namespace graspd::perception
