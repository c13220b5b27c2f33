#include "graspd/parts/triangle_groups.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace graspd::parts {
namespace {

using Corners = std::array<Eigen::Vector3f, 3>;

Eigen::Vector3f middle(const Corners& t) { return (t[0] + t[1] + t[2]) / 3; }

/// Halves at the longest side of the middles' box, at whole groups, down to one group.
void sort_into_groups(std::span<Corners> triangles) {
  if (triangles.size() <= TriangleGroups::kTriangles) return;
  Eigen::AlignedBox3f box;
  for (const Corners& triangle : triangles) box.extend(middle(triangle));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t groups_n =
      (triangles.size() + TriangleGroups::kTriangles - 1) / TriangleGroups::kTriangles;
  const std::size_t half = groups_n / 2 * TriangleGroups::kTriangles;
  std::nth_element(
      triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
      [&](const Corners& a, const Corners& b) { return middle(a)[axis] < middle(b)[axis]; });
  sort_into_groups(triangles.first(half));
  sort_into_groups(triangles.subspan(half));
}

}  // namespace

TriangleGroups::TriangleGroups(const Mesh& mesh) {
  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices_m[static_cast<std::size_t>(a)],
                         mesh.vertices_m[static_cast<std::size_t>(b)],
                         mesh.vertices_m[static_cast<std::size_t>(c)]});
  }
  sort_into_groups(triangles);
  while (triangles.size() % kTriangles != 0) triangles.push_back(triangles.back());

  groups_n = triangles.size() / kTriangles;
  for (std::size_t first = 0; first < triangles.size(); first += kTriangles) {
    const std::span group(triangles.data() + first, kTriangles);
    Eigen::AlignedBox3f box;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const Corners& triangle : group) corners_m.push_back(triangle[corner][axis]);
      }
      for (const Corners& triangle : group) box.extend(triangle[corner]);
    }
    const Eigen::Vector3f centre_m = box.center();
    float reach2_m2 = 0;
    for (const Corners& triangle : group) {
      for (const auto& p : triangle) reach2_m2 = std::max(reach2_m2, (p - centre_m).squaredNorm());
    }
    x_m.push_back(centre_m.x());
    y_m.push_back(centre_m.y());
    z_m.push_back(centre_m.z());
    radius_m.push_back(std::sqrt(reach2_m2));
  }
  for (auto* of : {&x_m, &y_m, &z_m}) of->resize(groups_n + kTriangles, 0);
  // Squared, it is still below any distance.
  radius_m.resize(groups_n + kTriangles, 0);
  for (std::size_t i = groups_n; i < x_m.size(); ++i) x_m[i] = 1e6F;
}

}  // namespace graspd::parts
