/// Every triangle of a mesh is in one group, and in that group's sphere.
#include "graspd/parts/triangle_groups.hpp"

#include <gtest/gtest.h>

#include <set>

#include "graspd/parts/catalogue.hpp"

namespace graspd::parts {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

Corners triangle_of(const TriangleGroups& groups, std::size_t group, std::size_t i) {
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[k][axis] = groups.corners_m[TriangleGroups::kFloats * group +
                                          TriangleGroups::kTriangles * (3 * k + axis) + i];
    }
  }
  return corners;
}

TEST(TriangleGroups, HoldEachTriangleInASmallSphere) {
  const auto catalogue = Catalogue::load(std::filesystem::path(GRASPD_SOURCE_DIR) / "deploy/parts");
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  for (const Part& part : catalogue->parts()) {
    std::multiset<Corners> left;
    for (const auto& triangle : part.mesh.triangles) {
      Corners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f& p = part.mesh.vertices_m[static_cast<std::size_t>(triangle[k])];
        corners[k] = {p.x(), p.y(), p.z()};
      }
      left.insert(corners);
    }
    const TriangleGroups& groups = part.triangles;
    const std::size_t triangles_n = left.size();
    double beyond_m = 0;  // of the spheres, what no triangle needs for itself
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Eigen::Vector3f centre_m(groups.x_m[g], groups.y_m[g], groups.z_m[g]);
      double longest_m = 0;
      for (std::size_t i = 0; i < TriangleGroups::kTriangles; ++i) {
        const Corners corners = triangle_of(groups, g, i);
        for (const auto& p : corners) {
          EXPECT_LE((Eigen::Vector3f(p.data()) - centre_m).norm(), groups.radius_m[g] + 1e-6F);
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const Eigen::Vector3f a(corners[k].data());
          const Eigen::Vector3f b(corners[(k + 1) % 3].data());
          longest_m = std::max(longest_m, double{(b - a).norm()});
        }
        const auto found = left.find(corners);
        const bool is_filling = TriangleGroups::kTriangles * g + i >= triangles_n;
        if (is_filling) continue;
        ASSERT_NE(found, left.end()) << part.id << ", group " << g;
        left.erase(found);
      }
      beyond_m += double{groups.radius_m[g]} - longest_m / 2;
    }
    EXPECT_TRUE(left.empty()) << part.id;
    EXPECT_LT(beyond_m / static_cast<double>(groups.size()), part.radius_m / 4) << part.id;
  }
}

TEST(TriangleGroups, OfNothingAreNone) { EXPECT_EQ(TriangleGroups(Mesh{}).size(), 0U); }

}  // namespace
}  // namespace graspd::parts
