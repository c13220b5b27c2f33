#include "graspd/perception/preprocess.hpp"

#include <gtest/gtest.h>

#include <set>

#include "block_scene.hpp"
#include "graspd/perception/organised.hpp"
#include "random_points.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kHeight_m = 0.75;

/// A bin of 0.30 × 0.20 × 0.10 m on the floor below the camera.
PlanRequest request_with_bin() {
  PlanRequest request;
  request.T_base_camera = testing::T_base_camera_above(kHeight_m);
  request.bin = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.30, 0.20, 0.10), 0};
  request.parts = {{"block", 0}};
  return request;
}

testing::Block block_at(const Vector3d& p_base_m, const Vector3d& size_m, double yaw_rad = 0) {
  Eigen::Isometry3d T_base_block = Eigen::Isometry3d::Identity();
  T_base_block.translate(p_base_m);
  T_base_block.rotate(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()));
  return {testing::T_base_camera_above(kHeight_m).inverse() * T_base_block, size_m};
}

TEST(Unproject, PutsReadingsOnTheirRays) {
  DepthFrame frame{testing::kinect_v2(), 0.001, {}};
  frame.depth.assign(512 * 424, 0);
  frame.depth[205 * 512 + 255] = 700;  // on the axis
  frame.depth[0] = 1000;               // top left: x = −255/365.5, y = −205/365.5 at 1 m
  frame.depth[1] = 200;                // nearer than the sensor sees
  const Cloud cloud = unproject(frame, {});
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_TRUE(cloud.points_m[0].isApprox(Vector3f(-255 / 365.5f, -205 / 365.5f, 1), 1e-6f));
  EXPECT_TRUE(cloud.points_m[1].isApprox(Vector3f(0, 0, 0.7f), 1e-6f));
}

TEST(CameraModel, RaysAndProjectionAreInverse) {
  CameraIntrinsics camera = testing::kinect_v2();
  camera.distortion = {0.0905, -0.268, 0.001, -0.0005, 0.095};
  for (int u = 0; u < camera.width_px; u += 51) {
    for (int v = 0; v < camera.height_px; v += 53) {
      const Eigen::Vector2d pixel = project(camera, ray_through(camera, u, v) * 0.8);
      EXPECT_NEAR(pixel.x(), u, 0.02);
      EXPECT_NEAR(pixel.y(), v, 0.02);
    }
  }
}

TEST(VoxelGrid, AveragesEachCube) {
  Cloud cloud;
  cloud.points_m = {{0.0101f, 0.0101f, 0.0101f},
                    {0.0103f, 0.0105f, 0.0109f},
                    {-0.0001f, 0.0001f, 0.0001f},
                    {0.0001f, 0.0001f, 0.0001f}};
  const Cloud grid = voxel_grid(cloud, 0.002);
  // The first two share a cube; the last two are on either side of x = 0.
  ASSERT_EQ(grid.size(), 3U);
  const auto is_mean = [](const Vector3f& p) {
    return p.isApprox(Vector3f(0.0102f, 0.0103f, 0.0105f), 1e-5f);
  };
  EXPECT_EQ(std::count_if(grid.points_m.begin(), grid.points_m.end(), is_mean), 1);
}

TEST(VoxelGrid, KeepsOnePointPerOccupiedCubeOfAnyCloud) {
  std::mt19937 random(5);
  const Cloud cloud = testing::clumpy_cloud(random, 3000);
  constexpr float kVoxel_m = 0.003f;
  std::set<std::array<int, 3>> cubes;
  const auto cube_of = [](const Vector3f& p) {
    return std::array<int, 3>{static_cast<int>(std::floor(p.x() / kVoxel_m)),
                              static_cast<int>(std::floor(p.y() / kVoxel_m)),
                              static_cast<int>(std::floor(p.z() / kVoxel_m))};
  };
  for (const auto& p : cloud.points_m) cubes.insert(cube_of(p));
  const Cloud grid = voxel_grid(cloud, kVoxel_m);
  EXPECT_EQ(grid.size(), cubes.size());
}

TEST(VoxelGrid, OfAWholeRoomIsFiltered) {
  // 9 m at 2 mm are more cubes than 32 bits can number.
  Cloud cloud;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i) * 0.009f - 4.5f;
    cloud.points_m.emplace_back(x, -x, x);
    cloud.points_m.emplace_back(x, -x, x);
  }
  EXPECT_EQ(voxel_grid(cloud, 0.002).size(), 1000U);
}

TEST(FindFloor, FindsThePlaneUnderBlocks) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kHeight_m,
                                           {block_at({0, 0, 0.02}, {0.06, 0.04, 0.04}),
                                            block_at({0.1, 0.05, 0.01}, {0.05, 0.05, 0.02})});
  const Cloud cloud = voxel_grid(unproject(frame, {}), 0.004);
  const auto floor = find_floor(cloud, std::nullopt, {});
  ASSERT_TRUE(floor);
  EXPECT_NEAR(floor->normal.z(), -1, 1e-3) << "towards the camera";
  EXPECT_NEAR(floor->height_m({0, 0, 0.75f}), 0, 0.002);
  EXPECT_NEAR(floor->height_m({0, 0, 0.71f}), 0.04, 0.002);
}

TEST(FindFloor, TakesNoFaceWithPointsBehindIt) {
  // A block's top face is the largest plane, but half of the scene lies below it.
  Cloud cloud;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-0.1f, 0.1f);
  for (int i = 0; i < 1000; ++i) {
    const float x = uniform(random);
    cloud.points_m.emplace_back(x, uniform(random), 0.6f);
  }
  for (int i = 0; i < 500; ++i) {
    const float x = uniform(random);
    const float y = uniform(random);
    cloud.points_m.emplace_back(x, y, 0.7f + uniform(random) / 2);
  }
  EXPECT_FALSE(find_floor(cloud, std::nullopt, {}));
}

TEST(FindFloor, OfFewPointsIsNone) {
  EXPECT_FALSE(find_floor({}, std::nullopt, {}));
  Cloud two;
  two.points_m = {{0, 0, 1}, {1, 0, 1}};
  EXPECT_FALSE(find_floor(two, std::nullopt, {}));
}

TEST(EstimateNormals, PointTowardsTheCamera) {
  const DepthFrame frame = testing::render(testing::kinect_v2(), kHeight_m, {});
  Cloud cloud = voxel_grid(unproject(frame, {}), 0.01);
  estimate_normals(cloud, {});
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  ASSERT_EQ(cloud.curvatures.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(cloud.normals[i].z(), -0.98);
    EXPECT_LT(cloud.curvatures[i], 0.01);
  }
}

/// One suite for the paper's preprocessing and the organised one.
class EveryPreprocessing : public ::testing::TestWithParam<decltype(&preprocess)> {
 protected:
  static Scene scene_of(const DepthFrame& frame, const PlanRequest& request) {
    return GetParam()(frame, request, 0.08, {});
  }
};

INSTANTIATE_TEST_SUITE_P(Paths, EveryPreprocessing,
                         ::testing::Values(preprocess, preprocess_organised),
                         [](const auto& path) { return path.index == 0 ? "Paper" : "Organised"; });

TEST_P(EveryPreprocessing, KeepsWhatLiesInTheBinAboveItsFloor) {
  const DepthFrame frame =
      testing::render(testing::kinect_v2(), kHeight_m,
                      {block_at({0, 0, 0.02}, {0.06, 0.04, 0.04}),
                       block_at({0.25, 0, 0.02}, {0.06, 0.04, 0.04})});  // outside
  const Scene scene = scene_of(frame, request_with_bin());
  ASSERT_GT(scene.cloud.size(), 200U);
  const Eigen::Isometry3d T_base_camera = testing::T_base_camera_above(kHeight_m);
  for (const auto& p_camera : scene.cloud.points_m) {
    const Vector3d p = T_base_camera * p_camera.cast<double>();
    EXPECT_LT(std::abs(p.x()), 0.034);
    EXPECT_GT(p.z(), 0.005);
  }
  const Funnel& funnel = scene.funnel;
  EXPECT_EQ(funnel.pixels_n, 512U * 424);
  EXPECT_EQ(funnel.readings_n, 512U * 424);
  EXPECT_LT(funnel.after_passthrough_n, funnel.readings_n);
  EXPECT_LE(funnel.after_voxel_grid_n, funnel.after_passthrough_n);
  EXPECT_LT(funnel.after_plane_n, funnel.after_voxel_grid_n);
  // A block 0.06 × 0.04 × 0.04 in a bin of 0.29 × 0.19 × 0.10 m.
  ASSERT_TRUE(scene.fill_level);
  EXPECT_NEAR(*scene.fill_level, 0.06 * 0.04 * 0.04 / (0.29 * 0.19 * 0.10), 0.004);
  EXPECT_TRUE(scene.T_camera_floor.isApprox(T_base_camera.inverse(), 1e-9));
}

TEST_P(EveryPreprocessing, WithoutABinFindsTheFloorByItself) {
  PlanRequest request = request_with_bin();
  request.bin.reset();
  const DepthFrame frame = testing::render(testing::kinect_v2(), kHeight_m,
                                           {block_at({0, 0, 0.02}, {0.06, 0.04, 0.04})});
  const Scene scene = scene_of(frame, request);
  const Vector3d up = scene.T_camera_floor.linear().col(2);
  EXPECT_NEAR(up.z(), -1, 1e-3);
  EXPECT_FALSE(scene.fill_level);
  float highest_m = 0;
  for (const auto& p : scene.cloud.points_m) {
    highest_m = std::max(
        highest_m, static_cast<float>((scene.T_camera_floor.inverse() * p.cast<double>()).z()));
  }
  EXPECT_NEAR(highest_m, 0.04, 0.002);
}

TEST_P(EveryPreprocessing, WithoutABinLeavesOutWhatStandsBesideTheFloor) {
  PlanRequest request = request_with_bin();
  request.bin.reset();
  const testing::Block part = block_at({0, 0, 0.02}, {0.06, 0.04, 0.04});
  DepthFrame frame = testing::render(testing::kinect_v2(), kHeight_m, {part});
  // A wall at the right edge of the image, with nothing seen behind it.
  const testing::Block wall = block_at({0.40, 0, 0.06}, {0.06, 1.0, 0.12});
  const DepthFrame with_wall = testing::render(testing::kinect_v2(), kHeight_m, {part, wall});
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (i % 512 > 410) frame.depth[i] = i % 512 > 470 ? with_wall.depth[i] : 0;
  }
  const Scene scene = scene_of(frame, request);
  ASSERT_GT(scene.cloud.size(), 300U);
  for (const auto& p : scene.cloud.points_m) EXPECT_LT(std::abs(p.x()), 0.034) << "the part's";
}

TEST_P(EveryPreprocessing, WithoutAnyFloorKeepsEverythingAndSaysSo) {
  PlanRequest request = request_with_bin();
  request.bin.reset();
  DepthFrame frame{testing::kinect_v2(), 0.001, std::vector<std::uint16_t>(512 * 424, 0)};
  std::mt19937 random(1);
  for (int v = 100; v < 300; ++v) {
    for (int u = 100; u < 300; ++u) {
      frame.depth[v * 512 + u] = static_cast<std::uint16_t>(600 + random() % 150);
    }
  }
  const Scene scene = scene_of(frame, request);
  EXPECT_EQ(scene.cloud.size(), scene.funnel.after_voxel_grid_n);
  ASSERT_EQ(scene.warnings.size(), 1U);
  for (const auto& p : scene.cloud.points_m) {
    EXPECT_GE((scene.T_camera_floor.inverse() * p.cast<double>()).z(), -1e-6);
  }
}

}  // namespace
}  // namespace graspd::perception
