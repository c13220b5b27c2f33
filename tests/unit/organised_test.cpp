#include "graspd/perception/organised.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "block_scene.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kFloor_m = 0.75;

class Organised : public ::testing::Test {
 protected:
  Organised() {
    request_.T_base_camera = testing::T_base_camera_above(kFloor_m);
    request_.bin = Bin{Eigen::Isometry3d::Identity(), Vector3d(0.30, 0.20, 0.10), 0};
  }
  static testing::Block block_at(double x_m, double y_m, const Vector3d& size_m) {
    testing::Block block;
    block.T_camera_block.translation() = Vector3d(x_m, y_m, kFloor_m - size_m.z() / 2);
    block.size_m = size_m;
    return block;
  }
  Scene scene_of(const DepthFrame& frame) const {
    return preprocess_organised(frame, request_, 0.08, parameters_);
  }
  static std::uint16_t& reading(DepthFrame& frame, int u, int v) {
    return frame.depth[static_cast<std::size_t>(v * frame.camera.width_px + u)];
  }
  /// The points that a pixel of the frame became.
  static std::size_t count_at(const Scene& scene, const DepthFrame& frame, int u, int v) {
    const auto& points_m = scene.cloud.points_m;
    return static_cast<std::size_t>(
        std::count_if(points_m.begin(), points_m.end(), [&](const Vector3f& p) {
          const Eigen::Vector2d pixel = project(frame.camera, p.cast<double>());
          return (pixel - Eigen::Vector2d(u, v)).norm() < 0.1;
        }));
  }

  PreprocessParameters parameters_;
  PlanRequest request_;
};

TEST_F(Organised, EachPointLiesOnTheRayOfItsCell) {
  CameraIntrinsics camera = testing::kinect_v2();
  for (const bool is_distorted : {false, true}) {
    if (is_distorted) camera.distortion = {0.09, -0.27, 0.001, -0.002, 0.1};  // a Kinect v2's
    const Scene scene =
        scene_of(testing::render(camera, kFloor_m, {block_at(0.03, -0.02, {0.08, 0.06, 0.04})}));
    const Cloud& cloud = scene.cloud;
    ASSERT_TRUE(scene.grid);
    const DepthGrid& grid = *scene.grid;
    ASSERT_GT(cloud.size(), 1000U);
    ASSERT_TRUE(cloud.is_organised());
    EXPECT_EQ(cloud.pixels.width_px, grid.width_px);
    EXPECT_TRUE(std::is_sorted(cloud.cells.begin(), cloud.cells.end()));
    EXPECT_EQ(std::set(cloud.cells.begin(), cloud.cells.end()).size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto width = static_cast<std::uint32_t>(grid.width_px);
      const auto u = static_cast<int>(cloud.cells[i] % width);
      const auto v = static_cast<int>(cloud.cells[i] / width);
      EXPECT_LT((cloud.points_m[i] - grid.point_m(u, v)).norm(), 1e-5F);
      EXPECT_EQ(grid.is_part[cloud.cells[i]], 1);
      EXPECT_NEAR(cloud.normals[i].norm(), 1, 1e-4);
      EXPECT_LT(cloud.normals[i].dot(cloud.points_m[i]), 0) << "towards the camera";
    }
  }
}

TEST_F(Organised, ReadingsBetweenTwoSurfacesAreDroppedAndEdgesStay) {
  DepthFrame frame =
      testing::render(testing::kinect_v2(), kFloor_m, {block_at(0, 0, {0.08, 0.06, 0.05})});
  // The block's right side, some rows down from the middle: its last pixel, and the one after it.
  const int v = 205;
  int u = 255;
  while (reading(frame, u + 1, v) < 710) ++u;
  for (int k = -8; k <= 8; ++k) {
    reading(frame, u + 1, v + k) = static_cast<std::uint16_t>(715 + (k * 37 + 300) % 30);
  }
  const Scene scene = scene_of(frame);
  int floating_n = 0;
  for (int k = -7; k <= 7; ++k) {
    EXPECT_EQ(count_at(scene, frame, u, v + k), 1U) << "the edge, row " << k;
    floating_n += static_cast<int>(count_at(scene, frame, u + 1, v + k));
  }
  EXPECT_LE(floating_n, 3) << "but where three happen to agree";
}

TEST_F(Organised, LoneHolesAreFilledAndWideOnesStay) {
  DepthFrame frame =
      testing::render(testing::kinect_v2(), kFloor_m, {block_at(0, 0, {0.08, 0.06, 0.05})});
  reading(frame, 250, 200) = 0;
  for (int k = 0; k < 9; ++k) reading(frame, 260 + k % 3, 210 + k / 3) = 0;
  const Scene scene = scene_of(frame);
  EXPECT_EQ(count_at(scene, frame, 250, 200), 1U);
  for (int k = 0; k < 9; ++k) EXPECT_EQ(count_at(scene, frame, 260 + k % 3, 210 + k / 3), 0U);
}

TEST_F(Organised, APlateOfSixMillimetresIsNotTheFloors) {
  // As thick as our bracket's legs, and half a millimetre too far, as half of its readings are.
  constexpr int kPlateAbove_dmm = 55;
  parameters_.wall_bow_m = 0;  // what is rendered is straight
  DepthFrame frame = testing::render(testing::kinect_v2(), kFloor_m, {});
  frame.depth_scale_m = 1e-4;
  for (std::uint16_t& depth : frame.depth) depth = static_cast<std::uint16_t>(depth * 10);
  for (int v = 196; v < 215; ++v) {
    for (int u = 241; u < 270; ++u) {
      reading(frame, u, v) = static_cast<std::uint16_t>(reading(frame, u, v) - kPlateAbove_dmm);
    }
  }
  EXPECT_EQ(scene_of(frame).cloud.size(), 19U * 29U);
}

TEST_F(Organised, ABinThatIsPartlyOutOfSightIsCutAtTheImagesEdge) {
  const DepthFrame frame =
      testing::render(testing::kinect_v2(), kFloor_m, {block_at(-0.5, 0, {0.08, 0.06, 0.05})});
  request_.bin->T_base_bin.translation().x() = -0.5;
  const Scene scene = scene_of(frame);
  EXPECT_GT(scene.funnel.after_passthrough_n, 1000U);
  EXPECT_GT(scene.cloud.size(), 100U);
  request_.bin->T_base_bin.translation().x() = -3;
  EXPECT_EQ(scene_of(frame).funnel.after_passthrough_n, 0U);
}

TEST_F(Organised, IslandsWithoutASegmentBecomeFloor) {
  const Vector3d size_m(0.05, 0.05, 0.04);
  Scene scene = scene_of(testing::render(testing::kinect_v2(), kFloor_m,
                                         {block_at(-0.08, 0, size_m), block_at(0.08, 0, size_m)}));
  Indices left;
  for (std::uint32_t i = 0; i < scene.cloud.size(); ++i) {
    if (scene.cloud.points_m[i].x() < -0.07F) left.push_back(i);
  }
  drop_islands_without_segments(std::vector<Indices>{left}, scene);
  for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
    EXPECT_EQ(scene.grid->is_part[scene.cloud.cells[i]], scene.cloud.points_m[i].x() < 0 ? 1 : 0);
  }
}

/// A floor of `floor_n` points with 2 mm of noise, and others up to 80 mm above it.
Cloud floor_and_heap(int floor_n, int heap_n) {
  std::mt19937 random(12);
  std::normal_distribution<float> noise_m(0, 0.002F);
  std::uniform_real_distribution<float> side_m(-0.15F, 0.15F), height_m(0.01F, 0.08F);
  Cloud cloud;
  for (int i = 0; i < floor_n + heap_n; ++i) {
    const float x = side_m(random);
    const float y = side_m(random);
    const float above_m = i < floor_n ? noise_m(random) : height_m(random);
    cloud.points_m.emplace_back(x, y, 0.75F + 0.1F * x - above_m);
  }
  std::shuffle(cloud.points_m.begin(), cloud.points_m.end(), random);
  return cloud;
}

TEST(FitFloor, IsWhereMostPointsAreNotWhereThreeAre) {
  for (const int heap_n : {0, 4000, 20'000}) {
    const auto floor = fit_floor(floor_and_heap(8000, heap_n), std::nullopt, {});
    ASSERT_TRUE(floor) << heap_n;
    const Vector3f normal = Vector3f(0.1F, 0, -1).normalized();
    EXPECT_GT(floor->normal.dot(normal), std::cos(0.01F)) << heap_n;
    EXPECT_NEAR(floor->height_m({0, 0, 0.75F}), 0, 0.0015) << heap_n;
  }
}

TEST(FitFloor, TakesNoPlaneThatIsFarFromUpright) {
  const Cloud cloud = floor_and_heap(8000, 1000);
  EXPECT_TRUE(fit_floor(cloud, Vector3f(0, 0, -1), {}));
  EXPECT_FALSE(fit_floor(cloud, Vector3f(0, -1, 0), {}));
}

TEST(FitFloor, OfALineOrASpotIsNone) {
  Cloud line, spot;
  for (int i = 0; i < 200; ++i) {
    line.points_m.emplace_back(0.001F * static_cast<float>(i), 0.0F, 0.7F);
    spot.points_m.emplace_back(0.1F, 0.1F, 0.7F);
  }
  EXPECT_FALSE(fit_floor(line, std::nullopt, {}));
  EXPECT_FALSE(fit_floor(spot, std::nullopt, {}));
  EXPECT_FALSE(fit_floor({}, std::nullopt, {}));
}

}  // namespace
}  // namespace graspd::perception
