#include "graspd/perception/grid_dbscan.hpp"

#include <gtest/gtest.h>

#include "block_scene.hpp"
#include "graspd/perception/organised.hpp"
#include "random_points.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// The depth at a pixel, or 0.
using DepthAt = std::function<float(int u, int v)>;

Cloud organised_cloud(const PixelGrid& pixels, const DepthAt& depth_at) {
  Cloud cloud;
  cloud.pixels = pixels;
  for (int v = 0; v < pixels.height_px; ++v) {
    for (int u = 0; u < pixels.width_px; ++u) {
      const float z_m = depth_at(u, v);
      if (z_m <= 0) continue;
      cloud.points_m.emplace_back((static_cast<float>(u) - pixels.cx_px) / pixels.fx_px * z_m,
                                  (static_cast<float>(v) - pixels.cy_px) / pixels.fy_px * z_m, z_m);
      cloud.cells.push_back(static_cast<std::uint32_t>(v * pixels.width_px + u));
    }
  }
  return cloud;
}

/// Normals that differ a little, so that some borders merge and some do not.
void give_normals(std::mt19937& random, Cloud& cloud) {
  std::uniform_real_distribution<float> tilt(-0.15F, 0.15F), curvature(0, 0.08F);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float x = tilt(random);
    cloud.normals.push_back(Vector3f(x, tilt(random), -1).normalized());
    cloud.curvatures.push_back(curvature(random));
  }
}

/// Each pair of points, and nothing shared with the grid.
Neighbourhoods brute_force(const Cloud& cloud, float eps_m) {
  Neighbourhoods result;
  result.offsets.push_back(0);
  for (const Vector3f& p : cloud.points_m) {
    for (std::uint32_t j = 0; j < cloud.size(); ++j) {
      if ((p - cloud.points_m[j]).squaredNorm() <= eps_m * eps_m) result.indices.push_back(j);
    }
    result.offsets.push_back(static_cast<std::uint32_t>(result.indices.size()));
  }
  return result;
}

struct Compared {
  int clusters_n = 0;
  int merged_n = 0;
};

Compared expect_the_same(const Cloud& cloud, float eps_m, int min_points_n) {
  const Neighbourhoods neighbourhoods = brute_force(cloud, eps_m);
  DbscanResult expected = dbscan(cloud, neighbourhoods, min_points_n);
  const GridDbscan grid(cloud, eps_m, min_points_n);
  DbscanResult result = grid.cluster();
  EXPECT_EQ(result.is_core, expected.is_core);
  EXPECT_EQ(result.labels, expected.labels);
  EXPECT_EQ(result.clusters_n, expected.clusters_n);
  Compared compared{expected.clusters_n, expected.clusters_n};
  merge_at_borders(cloud, neighbourhoods, 0.2, 0.05, expected);
  grid.merge_at_borders(0.2, 0.05, result);
  EXPECT_EQ(result.labels, expected.labels);
  EXPECT_EQ(result.clusters_n, expected.clusters_n);
  compared.merged_n -= expected.clusters_n;
  return compared;
}

constexpr PixelGrid kPixels{48, 40, 365, 360, 20, 22};

/// Steps and slopes with noise and missing readings.
DepthAt rough_surfaces(std::mt19937& random) {
  return [&random](int u, int v) {
    if (random() % 8 == 0) return 0.0F;
    std::normal_distribution<float> noise(0, 0.0015F);
    const float step_m = 0.012F * static_cast<float>((u / 11 + v / 9) % 3);
    return 0.7F + step_m + 0.0004F * static_cast<float>(u) + noise(random);
  };
}

TEST(GridDbscan, IsDbscanOnRoughSurfaces) {
  std::mt19937 random(5);
  Compared total;
  for (const float eps_px : {1.2F, 2.2F, 2.7F, 5.0F}) {
    for (const int min_points_n : {1, 4, 9, 12, 30}) {
      Cloud cloud = organised_cloud(kPixels, rough_surfaces(random));
      give_normals(random, cloud);
      const Compared one = expect_the_same(cloud, eps_px * 0.7F / kPixels.fx_px, min_points_n);
      total.clusters_n += one.clusters_n;
      total.merged_n += one.merged_n;
    }
  }
  EXPECT_GT(total.clusters_n, 100);
  EXPECT_GT(total.merged_n, 5) << "else merging was not tried";
}

TEST(GridDbscan, IsDbscanOfNoiseFromNearToFar) {
  // The window of the nearest points is wider than a word of bits, that of the farthest one pixel.
  std::mt19937 random(6);
  std::uniform_real_distribution<float> depth_m(0.08F, 1.5F);
  for (const int min_points_n : {1, 3, 8}) {
    Cloud cloud = organised_cloud(kPixels, [&](int, int v) {
      return v < 20 ? depth_m(random) : depth_m(random) / 8 + 0.05F;
    });
    give_normals(random, cloud);
    expect_the_same(cloud, 0.006F, min_points_n);
  }
}

TEST(GridDbscan, IsDbscanAtTheImagesEdgesAndOnWideCameras) {
  // Rays at up to 60° from the axis, where a pixel is much wider than at the centre.
  std::mt19937 random(7);
  const PixelGrid wide{40, 30, 12, 11, 20, 15};
  std::uniform_real_distribution<float> depth_m(0.45F, 0.55F);
  Cloud cloud = organised_cloud(wide, [&](int, int) { return depth_m(random); });
  give_normals(random, cloud);
  for (const float eps_m : {0.03F, 0.08F, 0.2F}) expect_the_same(cloud, eps_m, 4);
}

TEST(GridDbscan, IsDbscanOfPointsWithinEpsOfTheCamera) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> depth_m(0.001F, 0.004F);
  Cloud cloud = organised_cloud({40, 9, 10, 10, 20, 4}, [&](int, int) { return depth_m(random); });
  give_normals(random, cloud);
  for (const int min_points_n : {4, 340, 352}) expect_the_same(cloud, 0.02F, min_points_n);
}

TEST(GridDbscan, ABorderPointBetweenTwoClustersGoesToTheFirst) {
  // Three rows: four columns, a gap with one point in its middle, and four columns.
  const PixelGrid pixels{11, 3, 365, 365, 5, 1};
  const Cloud cloud = organised_cloud(
      pixels, [](int u, int v) { return u < 4 || u > 6 || (u == 5 && v == 1) ? 0.7F : 0.0F; });
  const DbscanResult result = GridDbscan(cloud, 2.1F * 0.7F / 365, 6).cluster();
  EXPECT_EQ(result.clusters_n, 2);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(result.labels[i], cloud.points_m[i].x() > 0 ? 1 : 0) << "the middle is at 0";
  }
}

TEST(GridDbscan, IsDbscanOfAFrame) {
  std::mt19937 random(9);
  std::vector<testing::Block> blocks;
  for (int i = 0; i < 8; ++i) {
    testing::Block block;
    block.size_m = Vector3d(0.08, 0.03, 0.02);
    block.T_camera_block.translate(
        Vector3d(0.05 * (i % 4) - 0.08, (i < 4 ? 0.0 : 0.05), 0.70 - 0.004 * i));
    block.T_camera_block.rotate(testing::random_rotation(random));
    blocks.push_back(block);
  }
  DepthFrame frame = testing::render(testing::kinect_v2(), 0.75, blocks);
  std::normal_distribution<double> noise_mm(0, 1.3);
  for (std::uint16_t& reading : frame.depth) {
    reading = static_cast<std::uint16_t>(std::lround(reading + noise_mm(random)));
  }
  PlanRequest request;
  request.T_base_camera = testing::T_base_camera_above(0.75);
  request.bin = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.40, 0.30, 0.15), 0.005};
  const Cloud cloud = preprocess_organised(frame, request, 0.09, {}).cloud;
  ASSERT_GT(cloud.size(), 2000U);
  EXPECT_GT(expect_the_same(cloud, 0.0055F, 12).clusters_n, 4);
}

TEST(GridDbscan, OfNothingIsNothing) {
  const Cloud cloud;
  EXPECT_EQ(GridDbscan(cloud, 0.005F, 4).cluster().clusters_n, 0);
}

}  // namespace
}  // namespace graspd::perception
