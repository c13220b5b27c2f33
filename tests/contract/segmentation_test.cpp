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
                                           Segmentation::kEuclidean, Segmentation::kRegionGrowing),
                         [](const auto& method) { return std::string(name_of(method.param)); });

TEST(SegmentationNames, WithoutANameThrows) {
  EXPECT_THROW(segmentation_method(Segmentation::kServerDefault), std::invalid_argument);
}

}  // namespace
}  // namespace graspd::perception
