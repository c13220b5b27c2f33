/// The looked-up nearest template point against a search through all of them.
#include "graspd/parts/contact_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "random_pose.hpp"

namespace graspd::parts {
namespace {

using Eigen::Vector3f;

/// Points on a sphere and on a plate beside it: curved, flat, thin and apart.
std::vector<SurfacePoint> sphere_and_plate() {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::vector<SurfacePoint> surface;
  for (int i = 0; i < 600; ++i) {
    const Vector3f n = Vector3f(normal(random), normal(random), normal(random)).normalized();
    surface.push_back({0.012f * n, n});
  }
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      const Vector3f p_m(0.02f + 0.002f * float(x), 0.002f * float(y), 0.005f);
      surface.push_back({p_m, Vector3f::UnitZ()});
      surface.push_back({p_m - Vector3f(0, 0, 0.001f), -Vector3f::UnitZ()});
    }
  }
  return surface;
}

float distance_m(const std::vector<SurfacePoint>& surface, const Vector3f& p_m) {
  float least_m = std::numeric_limits<float>::max();
  for (const SurfacePoint& point : surface) {
    least_m = std::min(least_m, (point.position_m - p_m).norm());
  }
  return least_m;
}

class ContactModelTest : public ::testing::Test {
 protected:
  std::vector<SurfacePoint> surface_ = sphere_and_plate();
  ContactModel model_{surface_};
  std::mt19937 random_{1};
};

TEST_F(ContactModelTest, ThePatchesHoldEveryPointOnce) {
  ASSERT_EQ(model_.points().size(), surface_.size());
  std::uint32_t next = 0;
  for (const Patch& patch : model_.patches()) {
    EXPECT_EQ(patch.first, next);
    next += patch.points_n;
    for (std::uint32_t i = patch.first; i < next; ++i) {
      EXPECT_LE((model_.points()[i].position_m - patch.centre_m).norm(), patch.radius_m);
    }
  }
  EXPECT_EQ(next, surface_.size());
}

TEST_F(ContactModelTest, FindsAPointWhereASearchThroughAllDoesButForAFew) {
  int there_n = 0;
  int found_n = 0;
  for (const float within_m : {0.001f, 0.002f, 0.005f}) {
    for (int i = 0; i < 20000; ++i) {
      const Vector3f p_m = testing::random_point(random_, 0.08f);
      const bool is_there = distance_m(surface_, p_m) <= within_m;
      const SurfacePoint* found = model_.find_within(p_m, within_m);
      if (found != nullptr) {
        EXPECT_LE((found->position_m - p_m).norm(), within_m);
      }
      there_n += is_there;
      found_n += found != nullptr;
    }
  }
  EXPECT_GT(there_n, 1000);
  EXPECT_GT(found_n, 0.98 * there_n);
}

TEST_F(ContactModelTest, NoCellIsFartherFromTheTemplateThanItSays) {
  const DistanceGrid& grid = model_.grid();
  int near_n = 0;
  for (std::size_t i = 0; i < grid.distance_m.size(); i += 7) {
    const auto cell = static_cast<int>(i);
    const Eigen::Array3i at(cell % grid.size.x(), cell / grid.size.x() % grid.size.y(),
                            cell / grid.size.x() / grid.size.y());
    const Vector3f centre_m = grid.origin_m.array() + (at.cast<float>() + 0.5f) / grid.cells_per_m;
    const float true_m = distance_m(surface_, centre_m);
    const bool is_near = grid.distance_m[i] < DistanceGrid::kFar_m;
    if (is_near) {
      EXPECT_NEAR(grid.distance_m[i], true_m, 1e-5f);
    } else {
      EXPECT_GT(true_m, 2 * ContactModel::kMaxDistance_m);
    }
    near_n += is_near;
  }
  EXPECT_GT(near_n, 1000);
  EXPECT_EQ(grid.distance_m.front(), DistanceGrid::kFar_m);
}

TEST(ContactModel, WithoutPointsIsNearNothing) {
  EXPECT_EQ(ContactModel().find_within(Vector3f::Zero(), 0.001f), nullptr);
  EXPECT_TRUE(ContactModel(std::span<const SurfacePoint>()).points().empty());
}

}  // namespace
}  // namespace graspd::parts
