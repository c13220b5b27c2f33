/// The kernel that rules out what touches nothing, against a search through all points.
#include "contact_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "block_pile.hpp"
#include "contacts.hpp"
#include "random_pose.hpp"

namespace graspd::perception {
namespace {

using Eigen::Vector3f;

float distance_m(const parts::Part& part, const Vector3f& p_m) {
  float least_m = std::numeric_limits<float>::max();
  for (const parts::SurfacePoint& point : part.surface) {
    least_m = std::min(least_m, (point.position_m - p_m).norm());
  }
  return least_m;
}

TEST(ContactKernel, NoSphereThatTouchesIsRuledOutAndMostOthersAre) {
  const parts::Part block = testing::block_part("block", {0.030, 0.020, 0.010});
  constexpr float kWithin_m = 0.002f;
  constexpr float kRadius_m = 0.005f;
  std::mt19937 random(1);
  std::vector<Vector3f> centres_m;
  parts::SphereArrays spheres;
  for (int i = 0; i < 2005; ++i) {  // not a whole number of vectors
    centres_m.push_back(testing::random_point(random, 0.05f));
    spheres.push_back(centres_m.back(), kRadius_m);
  }
  spheres.pad();
  std::vector<bool> is_kept(centres_m.size());
  visit_spheres_near(spheres, 0, static_cast<std::uint32_t>(spheres.size),
                     kernel_pose(Eigen::Isometry3d::Identity()), span_of(block.contact.grid()),
                     kWithin_m, [&](std::uint32_t i) {
                       EXPECT_FALSE(is_kept[i]) << "visited twice";
                       is_kept[i] = true;
                     });
  int touching_n = 0;
  for (std::size_t i = 0; i < centres_m.size(); ++i) {
    const bool touches = distance_m(block, centres_m[i]) <= kRadius_m + kWithin_m;
    EXPECT_TRUE(is_kept[i] || !touches) << centres_m[i].transpose();
    touching_n += touches;
  }
  const auto kept_n = std::ranges::count(is_kept, true);
  EXPECT_GT(touching_n, 100);
  EXPECT_LT(kept_n, 1.5 * touching_n);
}

}  // namespace
}  // namespace graspd::perception
