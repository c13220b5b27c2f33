#include "graspd/perception/displacement.hpp"

#include <gtest/gtest.h>

namespace graspd::perception {
namespace {

using Eigen::Vector3d;

LastObject object(std::uint32_t id, const Vector3d& centroid_m) {
  LastObject object;
  object.id = id;
  object.p_base_segment_centroid_m = centroid_m;
  return object;
}

class Displacement : public ::testing::Test {
 protected:
  DisplacementParameters parameters_{.threshold_m = 0.005};
  LastPlan last_{{object(1, {0, 0, 0}), object(2, {0.1, 0, 0}), object(3, {0, 0.1, 0})}, 2U};
};

TEST_F(Displacement, NothingMoved) {
  const std::vector<Vector3d> centroids = {{0.001, 0, 0}, {0, 0.1, 0.0049}, {0.5, 0.5, 0}};
  const auto standing = unchanged_objects(last_, centroids, parameters_);
  ASSERT_TRUE(standing);
  ASSERT_EQ(standing->size(), 2U);
  EXPECT_EQ((*standing)[0].id, 1U);
  EXPECT_EQ((*standing)[1].id, 3U);
}

TEST_F(Displacement, OneMovedByMoreThanTheThreshold) {
  const std::vector<Vector3d> centroids = {{0.001, 0, 0}, {0, 0.1, 0.0051}};
  EXPECT_FALSE(unchanged_objects(last_, centroids, parameters_));
}

TEST_F(Displacement, ThePickedOneIsStillThere) {
  const std::vector<Vector3d> centroids = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  EXPECT_FALSE(unchanged_objects(last_, centroids, parameters_));
}

TEST_F(Displacement, NothingWasPicked) {
  last_.picked_object_id.reset();
  const std::vector<Vector3d> centroids = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  const auto standing = unchanged_objects(last_, centroids, parameters_);
  ASSERT_TRUE(standing);
  EXPECT_EQ(standing->size(), 3U);
}

TEST_F(Displacement, NothingIsLeft) {
  last_.objects = {object(2, {0.1, 0, 0})};
  EXPECT_FALSE(unchanged_objects(last_, std::vector<Vector3d>{{0, 0, 0}}, parameters_));
  last_.objects.clear();
  EXPECT_FALSE(unchanged_objects(last_, std::vector<Vector3d>{{0, 0, 0}}, parameters_));
}

}  // namespace
}  // namespace graspd::perception
