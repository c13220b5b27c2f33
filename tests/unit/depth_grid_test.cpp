#include "graspd/perception/depth_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "block_scene.hpp"
#include "graspd/perception/preprocess.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kFloorDepth_m = 0.75;

/// A block with its top face 50 mm above the floor.
std::vector<testing::Block> one_block() {
  testing::Block block;
  block.T_camera_block.translation() = Vector3d(0.03, -0.02, kFloorDepth_m - 0.03);
  block.size_m = Vector3d(0.08, 0.06, 0.04);
  return {block};
}

Cloud above_floor(const DepthFrame& frame) {
  Cloud cloud = unproject(frame, PreprocessParameters{});
  std::erase_if(cloud.points_m, [](const Vector3f& p) { return p.z() > kFloorDepth_m - 0.01; });
  return cloud;
}

TEST(DepthGrid, IsThePinholeImageOfTheReadings) {
  CameraIntrinsics camera = testing::kinect_v2();
  camera.distortion = {0.09, -0.27, 0.001, -0.002, 0.1};  // a Kinect v2's
  const DepthFrame frame = testing::render(camera, kFloorDepth_m, one_block());
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), PreprocessParameters{});
  int top_n = 0;
  for (int v = 1; v < grid.height_px - 1; ++v) {
    for (int u = 1; u < grid.width_px - 1; ++u) {
      const Vector3f p = grid.point_m(u, v);
      // Half a pixel within the face, which is a millimetre.
      if (std::abs(p.x() - 0.03F) > 0.038F || std::abs(p.y() + 0.02F) > 0.028F) continue;
      EXPECT_NEAR(p.z(), kFloorDepth_m - 0.05, 0.0006) << u << ", " << v;
      EXPECT_EQ(grid.cell_of(p), grid.index(u, v));
      EXPECT_EQ(grid.is_part[grid.index(u, v)], 1);
      ++top_n;
    }
  }
  EXPECT_GT(top_n, 900) << "80 × 60 mm at about 1.9 mm a pixel";
}

TEST(DepthGrid, HasAMarginAndNothingOutermost) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloorDepth_m, one_block());
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), PreprocessParameters{});
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
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloorDepth_m, blocks);
  const DepthGrid grid = make_depth_grid(frame, above_floor(frame), PreprocessParameters{});
  const Vector3f centre =
      (blocks[0].T_camera_block * Vector3d(0, 0, -0.02)).cast<float>();  // of the face on top
  const Vector3f normal = -blocks[0].T_camera_block.linear().col(2).cast<float>();
  EXPECT_GT(grid.normals[grid.cell_of(centre)].dot(normal), std::cos(0.05));
}

/// What the image says of one point.
PoseCounts counts_of(const DepthGrid& grid, const Vector3f& p_m) {
  const std::vector<float> padded(17, 0);
  const KernelPose pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {p_m.x(), p_m.y(), p_m.z()}};
  return count_evidence(grid.for_kernel(), pose, {padded.data(), padded.data(), padded.data(), 1},
                        0.006F);
}

TEST(DepthGrid, BesideASilhouetteNothingIsRefutedHoweverFineTheImage) {
  for (const double finer : {1, 2, 4}) {
    CameraIntrinsics camera = testing::kinect_v2();
    camera.fx_px *= finer;
    camera.fy_px *= finer;
    const DepthFrame frame = testing::render(camera, kFloorDepth_m, one_block());
    DepthGrid grid = make_depth_grid(frame, above_floor(frame), PreprocessParameters{});
    const auto beyond = [&](float beyond_m) {
      return counts_of(grid, Vector3f(0.07F + beyond_m, -0.02F, 0.70F));
    };
    EXPECT_EQ(beyond(0.0016F).refute_n, 0) << finer;
    EXPECT_EQ(beyond(0.0045F).refute_n, 1) << finer;

    // Nor beside what is claimed, at any depth.
    const Vector3f top_m(0.03F, -0.02F, 0.70F);
    const Vector3f beside_m(0.0316F, -0.02F, 0.70F);
    const float nearer = 0.9F;
    EXPECT_EQ(counts_of(grid, nearer * beside_m).refute_n, 1) << finer;
    grid.claim({static_cast<std::uint32_t>(grid.cell_of(top_m))});
    EXPECT_EQ(counts_of(grid, nearer * beside_m).refute_n, 0) << finer;
  }
}

TEST(DepthGrid, WhatIsClaimedHidesAndRefutesNothing) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kFloorDepth_m, one_block());
  DepthGrid grid = make_depth_grid(frame, above_floor(frame), PreprocessParameters{});
  const std::size_t cell = grid.cell_of({0.03F, -0.02F, 0.70F});
  const float z_m = grid.z_m[cell];
  EXPECT_TRUE(grid.is_open(cell));
  const auto counts_at = [&](std::size_t at, float depth_m) {
    const auto width = static_cast<std::size_t>(grid.width_px);
    const std::size_t u = at % width, v = at / width;
    return counts_of(grid,
                     depth_m * Vector3f((static_cast<float>(u) - grid.cx_px) / grid.fx_px,
                                        (static_cast<float>(v) - grid.cy_px) / grid.fy_px, 1));
  };
  EXPECT_EQ(counts_at(cell, z_m).support_n, 1);
  EXPECT_EQ(counts_at(cell + 1, z_m - 0.1F).refute_n, 1);
  grid.claim({static_cast<std::uint32_t>(cell)});
  EXPECT_FALSE(grid.is_open(cell));
  EXPECT_EQ(counts_at(cell, z_m).support_n, 0);
  EXPECT_EQ(counts_at(cell, z_m).hidden_n, 1);
  EXPECT_EQ(counts_at(cell + 1, z_m).support_n, 1) << "its neighbour still speaks for a pose";
  EXPECT_EQ(counts_at(cell + 1, z_m - 0.1F).refute_n, 0) << "but, at its edge, against none";
}

/// A grid of a step of 60 mm at u = 50, with white noise, smoothed along its rows where it is said.
DepthGrid noisy_step(float noise_m, double blur_sigma_px) {
  DepthGrid grid;
  grid.width_px = 100;
  grid.height_px = 80;
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, noise_m);
  for (int i = 0; i < grid.width_px * grid.height_px; ++i) {
    grid.z_m.push_back((i % grid.width_px < 50 ? 0.70F : 0.76F) + noise(random));
  }
  if (blur_sigma_px <= 0) return grid;
  const std::vector<float> z_m = grid.z_m;
  for (int i = 0; i < grid.width_px * grid.height_px; ++i) {
    double sum_m = 0, total = 0;
    for (int k = -4; k <= 4; ++k) {
      const int u = i % grid.width_px + k;
      if (u < 0 || u >= grid.width_px) continue;
      const double weight = std::exp(-k * k / (2 * blur_sigma_px * blur_sigma_px));
      sum_m += weight * double(z_m[std::size_t(i + k)]);
      total += weight;
    }
    grid.z_m[std::size_t(i)] = static_cast<float>(sum_m / total);
  }
  return grid;
}

/// Readings of a row that are neither the step's upper nor its lower side.
double between_n(const DepthGrid& grid) {
  int count = 0;
  for (const float z_m : grid.z_m) count += z_m > 0.71F && z_m < 0.75F;
  return double(count) / grid.height_px;
}

TEST(SharpenEdges, UndoesTheSensorsSmoothing) {
  DepthGrid grid = noisy_step(0.003F, 0.9);
  EXPECT_GT(sharpening_gain(grid), 3);
  const double before_n = between_n(grid);
  EXPECT_GT(before_n, 1.8) << "else there is nothing to mend";
  sharpen_edges(grid);
  EXPECT_LT(between_n(grid), before_n / 2);
}

TEST(SharpenEdges, LeavesAnImageThatNothingSmoothed) {
  for (const float noise_m : {0.0F, 0.0013F, 0.003F}) {
    DepthGrid grid = noisy_step(noise_m, 0);
    const std::vector<float> z_m = grid.z_m;
    EXPECT_EQ(sharpening_gain(grid), 0) << noise_m;
    sharpen_edges(grid);
    EXPECT_EQ(grid.z_m, z_m);
  }
}

}  // namespace
}  // namespace graspd::perception
