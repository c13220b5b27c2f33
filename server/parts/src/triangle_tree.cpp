#include "triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace graspd::parts {
namespace {

constexpr std::size_t kLeafTriangles = 4;
// Of the whole surface's box. The box of a long thin triangle is mostly empty, so that a search
// would look into many: triangles with longer edges are cut.
constexpr double kMaxEdge = 0.2;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kBoxMargin_m = 1e-9;  // the box of a triangle across an axis has no thickness

/// Christer Ericson, Real-Time Collision Detection (2005), 5.1.5: which corner, edge or inside the
/// point lies over is told by the signs of barycentric coordinates.
Eigen::Vector3d closest_point_m(const Triangle& triangle, const Eigen::Vector3d& p_m) {
  const auto& [a, b, c] = triangle.corners_m;
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const double d1 = ab.dot(p_m - a);
  const double d2 = ac.dot(p_m - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(p_m - b);
  const double d4 = ac.dot(p_m - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(p_m - c);
  const double d6 = ac.dot(p_m - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

/// Along a ray of unit direction (Möller and Trumbore 1997); infinite where it misses.
double ray_distance_m(const Triangle& triangle, const Eigen::Vector3d& from_m,
                      const Eigen::Vector3d& direction) {
  constexpr double kEdge = 1e-9;  // a ray through an edge must not slip between two triangles
  const auto& [a, b, c] = triangle.corners_m;
  const Eigen::Vector3d across = direction.cross(c - a);
  const double determinant = across.dot(b - a);
  if (determinant == 0) return kNever;
  const double u = across.dot(from_m - a) / determinant;
  const Eigen::Vector3d up = (from_m - a).cross(b - a);
  const double v = direction.dot(up) / determinant;
  return u < -kEdge || v < -kEdge || u + v > 1 + kEdge ? kNever : up.dot(c - a) / determinant;
}

/// Where a ray enters a box (slab method); infinite where it passes by.
/// \param inverse 1 over each coordinate of the direction; infinite where the ray runs along a
/// slab.
double entry_m(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m,
               const Eigen::Vector3d& inverse) {
  double enter_m = 0;
  double leave_m = kNever;
  for (int axis = 0; axis < 3; ++axis) {
    // The margin keeps 0 · ∞ away from rays that start in a side of the box.
    const double a_m = (box_m.min()[axis] - kBoxMargin_m - from_m[axis]) * inverse[axis];
    const double b_m = (box_m.max()[axis] + kBoxMargin_m - from_m[axis]) * inverse[axis];
    enter_m = std::max(enter_m, std::min(a_m, b_m));
    leave_m = std::min(leave_m, std::max(a_m, b_m));
  }
  return enter_m <= leave_m ? enter_m : kNever;
}

Eigen::AlignedBox3d box_of(std::span<const Triangle> triangles) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles) {
    for (const Eigen::Vector3d& corner_m : triangle.corners_m) box.extend(corner_m);
  }
  return box;
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& indices : mesh.triangles) triangles.push_back(triangle_of(mesh, indices));
  return triangles;
}

/// Halves longest edges, and the triangles with them, until none is longer.
void cut_edges(std::vector<Triangle>& triangles, double max_m) {
  for (std::size_t i = 0; i < triangles.size();) {
    const auto [a, b, c] = triangles[i].corners_m;
    const std::array lengths_m{(a - b).norm(), (b - c).norm(), (c - a).norm()};
    const auto longest = std::max_element(lengths_m.begin(), lengths_m.end());
    if (*longest <= max_m) {
      ++i;
      continue;
    }
    const auto k = static_cast<std::size_t>(longest - lengths_m.begin());
    const std::array corners_m{a, b, c, a, b};
    const Eigen::Vector3d middle_m = 0.5 * (corners_m[k] + corners_m[k + 1]);
    triangles[i] = {{corners_m[k], middle_m, corners_m[k + 2]}};
    triangles.push_back({{middle_m, corners_m[k + 1], corners_m[k + 2]}});
  }
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  // A triangle without area has its edges in its neighbours.
  std::erase_if(triangles_, [](const Triangle& t) { return !(t.area_m2() > 0); });
  cut_edges(triangles_, kMaxEdge * box_of(triangles_).diagonal().norm());
  nodes_.reserve(2 * triangles_.size() / kLeafTriangles + 1);
  if (!triangles_.empty()) build(0, triangles_.size());
}

TriangleTree::TriangleTree(const Mesh& mesh) : TriangleTree(triangles_of(mesh)) {}

std::size_t TriangleTree::build(std::size_t begin, std::size_t end) {
  const std::size_t index = nodes_.size();
  const std::span triangles = std::span(triangles_).subspan(begin, end - begin);
  const Eigen::AlignedBox3d box_m = box_of(triangles);
  nodes_.push_back({box_m, begin, end});
  if (triangles.size() <= kLeafTriangles) return index;
  Eigen::Index axis = 0;
  box_m.sizes().maxCoeff(&axis);
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                   triangles.end(), [axis](const Triangle& a, const Triangle& b) {
                     return a.centroid_m()[axis] < b.centroid_m()[axis];
                   });
  const std::size_t left = build(begin, begin + half);
  const std::size_t right = build(begin + half, end);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

void TriangleTree::search(std::size_t index, const Eigen::Vector3d& p_m, double enough_m2,
                          Foot& best) const {
  const Node& node = nodes_[index];
  if (node.left == 0) {
    for (std::size_t k = node.begin; k < node.end; ++k) {
      const Eigen::Vector3d position_m = closest_point_m(triangles_[k], p_m);
      const double squared_m2 = (p_m - position_m).squaredNorm();
      if (squared_m2 < best.squared_distance_m2) best = {squared_m2, position_m, &triangles_[k]};
    }
    return;
  }
  std::pair nearer{nodes_[node.left].box_m.squaredExteriorDistance(p_m), node.left};
  std::pair farther{nodes_[node.right].box_m.squaredExteriorDistance(p_m), node.right};
  if (farther.first < nearer.first) std::swap(nearer, farther);
  for (const auto& [squared_m2, child] : {nearer, farther}) {
    const bool is_enough = best.triangle != nullptr && best.squared_distance_m2 <= enough_m2;
    if (is_enough || squared_m2 >= best.squared_distance_m2) return;
    search(child, p_m, enough_m2, best);
  }
}

void TriangleTree::search(std::size_t index, const Ray& ray, double beyond_m, Hit& best) const {
  const Node& node = nodes_[index];
  if (node.left == 0) {
    for (std::size_t k = node.begin; k < node.end; ++k) {
      const double distance_m = ray_distance_m(triangles_[k], ray.from_m, ray.direction);
      if (distance_m > beyond_m && distance_m < best.distance_m)
        best = {distance_m, &triangles_[k]};
    }
    return;
  }
  std::pair nearer{entry_m(nodes_[node.left].box_m, ray.from_m, ray.inverse), node.left};
  std::pair farther{entry_m(nodes_[node.right].box_m, ray.from_m, ray.inverse), node.right};
  if (farther.first < nearer.first) std::swap(nearer, farther);
  for (const auto& [enter_m, child] : {nearer, farther}) {
    if (enter_m < best.distance_m) search(child, ray, beyond_m, best);
  }
}

bool TriangleTree::is_within(const Eigen::Vector3d& p_m, double distance_m) const {
  Foot best;
  best.squared_distance_m2 = distance_m * distance_m;
  if (!nodes_.empty()) search(0, p_m, best.squared_distance_m2, best);
  return best.triangle != nullptr;
}

TriangleTree::Foot TriangleTree::nearest(const Eigen::Vector3d& p_m) const {
  Foot best;
  if (!nodes_.empty()) search(0, p_m, 0, best);
  return best;
}

TriangleTree::Hit TriangleTree::first_hit(const Eigen::Vector3d& from_m,
                                          const Eigen::Vector3d& direction, double beyond_m) const {
  Hit best;
  if (!nodes_.empty()) search(0, {from_m, direction, direction.cwiseInverse()}, beyond_m, best);
  return best;
}

}  // namespace graspd::parts
