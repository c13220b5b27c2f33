// The tree against its twin, which looks at every triangle.

#include "triangle_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "part_test_support.hpp"
#include "random_pose.hpp"
#include "symmetry_meshes.hpp"

namespace graspd::parts {
namespace {

Mesh random_triangles(std::mt19937& random, int triangles_n, float side_m) {
  Mesh mesh;
  for (int i = 0; i < triangles_n; ++i) {
    const Eigen::Vector3f middle_m = testing::random_point(random, 1);
    for (int k = 0; k < 3; ++k) {
      mesh.vertices_m.emplace_back(middle_m + testing::random_point(random, side_m));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TriangleTree tree_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& indices : mesh.triangles) triangles.push_back(triangle_of(mesh, indices));
  return TriangleTree(std::move(triangles));
}

TEST(TriangleTree, FindsTheNearestPlaceOfAll) {
  std::mt19937 random(3);
  for (const float side_m : {0.02F, 0.2F, 1.5F}) {
    for (const int triangles_n : {1, 3, 40, 300}) {
      const Mesh mesh = random_triangles(random, triangles_n, side_m);
      const TriangleTree tree = tree_of(mesh);
      for (int i = 0; i < 30; ++i) {
        const Eigen::Vector3f p_m = testing::random_point(random, 2);
        const double brute_m = distance_m(mesh, p_m);
        const TriangleTree::Foot foot = tree.nearest(p_m.cast<double>());
        EXPECT_NEAR(std::sqrt(foot.squared_distance_m2), brute_m, 1e-5);
        EXPECT_NEAR((foot.position_m - p_m.cast<double>()).norm(), brute_m, 1e-5);
        EXPECT_TRUE(tree.is_within(p_m.cast<double>(), brute_m + 1e-4));
        EXPECT_FALSE(tree.is_within(p_m.cast<double>(), brute_m - 1e-4));
      }
    }
  }
}

/// Along the ray, by solving for each triangle; looks at every one.
double first_hit_m(const Mesh& mesh, const Eigen::Vector3d& from_m,
                   const Eigen::Vector3d& direction, double beyond_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& indices : mesh.triangles) {
    const auto& [a, b, c] = triangle_of(mesh, indices).corners_m;
    Eigen::Matrix3d system;
    system << -direction, b - a, c - a;
    const Eigen::Vector3d suv = system.inverse() * (from_m - a);
    const bool is_hit = suv[1] >= 0 && suv[2] >= 0 && suv[1] + suv[2] <= 1 && suv[0] > beyond_m;
    if (is_hit) nearest_m = std::min(nearest_m, suv[0]);
  }
  return nearest_m;
}

TEST(TriangleTree, FindsTheFirstTriangleOnARayOfAll) {
  std::mt19937 random(5);
  int hits_n = 0;
  for (const float side_m : {0.2F, 1.5F}) {
    for (const int triangles_n : {1, 40, 300}) {
      const Mesh mesh = random_triangles(random, triangles_n, side_m);
      const TriangleTree tree = tree_of(mesh);
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d from_m = testing::random_point(random, 2).cast<double>();
        const Eigen::Vector3d direction =
            (testing::random_point(random, 1).cast<double>() - from_m).normalized();
        const double beyond_m = i % 2 == 0 ? 0 : 0.5;
        const auto hit = tree.first_hit(from_m, direction, beyond_m);
        const double brute_m = first_hit_m(mesh, from_m, direction, beyond_m);
        if (std::isinf(brute_m)) {
          EXPECT_EQ(hit.triangle, nullptr);
        } else {
          ++hits_n;
          EXPECT_NEAR(hit.distance_m, brute_m, 1e-6);
          ASSERT_NE(hit.triangle, nullptr);
        }
      }
    }
  }
  EXPECT_GT(hits_n, 50);
}

TEST(TriangleTree, RaysAlongAxesMeetFacesEdgesAndCornersOfABox) {
  const TriangleTree tree(box_mesh({0, 0, 0}, {0.5F, 0.5F, 0.5F}, 2));
  for (const double y : {0.0, 0.1, 0.25, 0.5}) {  // faces, inner edges, and along outer faces
    for (const double z : {0.0, 0.25, 0.3, 0.5}) {
      const auto hit = tree.first_hit({-1, y, z}, Eigen::Vector3d::UnitX());
      EXPECT_NEAR(hit.distance_m, 1, 1e-9) << y << " " << z;
      const auto second = tree.first_hit({-1, y, z}, Eigen::Vector3d::UnitX(), 1.4);
      EXPECT_NEAR(second.distance_m, 1.5, 1e-9) << y << " " << z;
    }
  }
  EXPECT_EQ(tree.first_hit({-1, 0.6, 0.1}, Eigen::Vector3d::UnitX()).triangle, nullptr);
  EXPECT_EQ(tree.first_hit({-1, 0.1, 0.1}, -Eigen::Vector3d::UnitX()).triangle, nullptr);
}

TEST(TriangleTree, CutsLongTrianglesAndKeepsTheirArea) {
  const Mesh bar = box_mesh({0, 0, 0}, {1, 0.01F, 0.01F});
  const TriangleTree tree = tree_of(bar);
  double area_m2 = 0;
  for (const Triangle& triangle : tree.triangles()) {
    area_m2 += triangle.area_m2();
    EXPECT_LT((triangle.corners_m[0] - triangle.corners_m[1]).norm(), 0.21);
  }
  EXPECT_NEAR(area_m2, surface_area_m2(bar), 1e-9);
}

TEST(TriangleTree, OfNoTriangleWithAreaHasNoPlace) {
  std::mt19937 random(1);
  const Mesh line = scaled(random_triangles(random, 5, 0.1F), 0);
  EXPECT_FALSE(tree_of(line).is_within(Eigen::Vector3d::Zero(), 10));
  EXPECT_EQ(tree_of(line).nearest(Eigen::Vector3d::Zero()).triangle, nullptr);
}

}  // namespace
}  // namespace graspd::parts
