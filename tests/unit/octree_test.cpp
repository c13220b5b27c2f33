#include "graspd/perception/octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_points.hpp"

namespace graspd::perception {
namespace {

Indices brute_force(const Cloud& cloud, const Eigen::Vector3f& centre_m, float radius_m) {
  Indices found;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if ((cloud.points_m[i] - centre_m).squaredNorm() <= radius_m * radius_m) found.push_back(i);
  }
  return found;
}

class OctreeTwin : public ::testing::TestWithParam<int> {};

TEST_P(OctreeTwin, RadiusSearchFindsWhatBruteForceFinds) {
  std::mt19937 random(7);
  for (const std::size_t count : {1U, 2U, 9U, 100U, 2000U}) {
    const Cloud cloud = testing::clumpy_cloud(random, count);
    const Octree octree(cloud.points_m, GetParam());
    std::vector<std::uint32_t> found;
    for (int query = 0; query < 200; ++query) {
      const Eigen::Vector3f centre_m =
          query % 2 == 0 ? cloud.points_m[random() % count] : testing::random_point(random, 0.2f);
      const float radius_m = 0.001f * static_cast<float>(random() % 30);
      octree.radius_search(centre_m, radius_m, found);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, brute_force(cloud, centre_m, radius_m)) << count << " points";
    }
  }
}

TEST_P(OctreeTwin, NeighbourhoodsAreSortedAndComplete) {
  std::mt19937 random(8);
  const Cloud cloud = testing::clumpy_cloud(random, 1500);
  const Neighbourhoods neighbourhoods = Octree(cloud.points_m, GetParam()).neighbourhoods(0.004f);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const auto of_i = neighbourhoods.of(i);
    ASSERT_EQ(Indices(of_i.begin(), of_i.end()), brute_force(cloud, cloud.points_m[i], 0.004f));
  }
}

INSTANTIATE_TEST_SUITE_P(Depths, OctreeTwin, ::testing::Values(1, 3, 8, 16));

TEST(Octree, OfNothingFindsNothing) {
  const Octree octree({}, 8);
  std::vector<std::uint32_t> found{1, 2, 3};
  octree.radius_search(Eigen::Vector3f::Zero(), 1, found);
  EXPECT_TRUE(found.empty());
  EXPECT_TRUE(octree.neighbourhoods(1).indices.empty());
}

TEST(Octree, PointsOnOneSpotAreAllFound) {
  const std::vector<Eigen::Vector3f> points(100, Eigen::Vector3f(1, 2, 3));
  const Neighbourhoods neighbourhoods = Octree(points, 8).neighbourhoods(0.001f);
  EXPECT_EQ(neighbourhoods.of(42).size(), 100U);
}

}  // namespace
}  // namespace graspd::perception
