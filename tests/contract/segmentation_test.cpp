/// One suite that every segmentation method passes.
#include "graspd/perception/segmentation.hpp"

#include <gtest/gtest.h>

#include <set>

#include "graspd/perception/preprocess.hpp"
#include "random_points.hpp"

namespace graspd::perception {
namespace {

/// Flat patches of 30 × 30 mm, a point each 1.5 mm, `gap_m` apart.
Cloud patches(int count, float gap_m) {
  constexpr float kStep_m = 0.0015f;
  constexpr int kSide = 20;
  Cloud cloud;
  for (int patch = 0; patch < count; ++patch) {
    const float x0_m = static_cast<float>(patch) * (kSide * kStep_m + gap_m);
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        cloud.points_m.emplace_back(x0_m + kStep_m * static_cast<float>(i),
                                    kStep_m * static_cast<float>(j), 0.7f);
      }
    }
  }
  estimate_normals(cloud, {});
  return cloud;
}

class EverySegmentation : public ::testing::TestWithParam<Segmentation> {
 protected:
  std::vector<Indices> segment(const Cloud& cloud) const {
    return segmentation_method(GetParam())(cloud, parameters_);
  }
  SegmentationParameters parameters_ = [] {
    SegmentationParameters parameters;
    parameters.min_points_n = 5;
    return parameters;
  }();
};

TEST_P(EverySegmentation, SeparatesWhatIsApart) {
  const auto segments = segment(patches(4, 0.03f));
  ASSERT_EQ(segments.size(), 4U);
  for (const Indices& one : segments) EXPECT_GE(one.size(), 396U) << "but for the corners";
}

TEST_P(EverySegmentation, KeepsOneSurfaceWhole) { ASSERT_EQ(segment(patches(1, 0)).size(), 1U); }

TEST_P(EverySegmentation, GivesDisjointSortedClustersInAFixedOrder) {
  std::mt19937 random(11);
  Cloud cloud = testing::clumpy_cloud(random, 2000);
  estimate_normals(cloud, {});
  const auto segments = segment(cloud);
  std::set<std::uint32_t> seen;
  std::uint32_t last_first = 0;
  for (const Indices& one : segments) {
    ASSERT_FALSE(one.empty());
    EXPECT_TRUE(std::is_sorted(one.begin(), one.end()));
    EXPECT_TRUE(&one == &segments.front() || one.front() > last_first);
    last_first = one.front();
    for (const std::uint32_t i : one) {
      EXPECT_LT(i, cloud.size());
      EXPECT_TRUE(seen.insert(i).second);
    }
  }
  EXPECT_EQ(segment(cloud), segments);
}

TEST_P(EverySegmentation, OfNothingIsNothing) { EXPECT_TRUE(segment({}).empty()); }

INSTANTIATE_TEST_SUITE_P(Names, EverySegmentation,
                         ::testing::Values(Segmentation::kImprovedDbscan, Segmentation::kDbscan,
                                           Segmentation::kEuclidean, Segmentation::kRegionGrowing,
                                           Segmentation::kGridDbscan),
                         [](const auto& method) { return std::string(name_of(method.param)); });

/// Organised points of rough, sloping steps, from `nearest_m` on.
Cloud slope(float nearest_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise_m(0, 0.004F);
  Cloud cloud;
  cloud.pixels = {60, 50, 365, 365, 30, 25};
  for (std::uint32_t cell = 0; cell < 60 * 50; ++cell) {
    const auto u = static_cast<float>(cell % 60);
    const std::uint32_t row = cell / 60, step = row / 7;
    const auto v = static_cast<float>(row);
    const float z_m = nearest_m + 0.003F * u + 0.02F * static_cast<float>(step) + noise_m(random);
    cloud.points_m.emplace_back((u - 30) / 365 * z_m, (v - 25) / 365 * z_m, z_m);
    cloud.cells.push_back(cell);
  }
  estimate_normals(cloud, {});
  return cloud;
}

TEST(GridSegmentation, FindsWhatTheOctreeFindsNearAndFar) {
  for (const float nearest_m : {0.003F, 0.7F}) {  // the first is a window that fits no image
    const Cloud cloud = slope(nearest_m);
    double z_sum_m = 0;
    for (const auto& p : cloud.points_m) z_sum_m += static_cast<double>(p.z());
    SegmentationParameters parameters;
    parameters.eps_m = parameters.grid_eps_px * z_sum_m / static_cast<double>(cloud.size()) / 365;
    parameters.min_points_n = parameters.grid_min_points_n = 5;
    const auto segments = grid_dbscan(cloud, parameters);
    EXPECT_EQ(segments, improved_dbscan(cloud, parameters));
    EXPECT_GT(segments.size(), 1U);
  }
}

TEST(SegmentationNames, WithoutANameThrows) {
  EXPECT_THROW(segmentation_method(Segmentation::kServerDefault), std::invalid_argument);
}

}  // namespace
}  // namespace graspd::perception
