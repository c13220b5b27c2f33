#include "wall_thickness.hpp"

#include <cmath>
#include <limits>

#include "mesh_geometry.hpp"
#include "visit_surface.hpp"

namespace graspd::parts {
namespace {

constexpr double kPoints = 400;
constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kItself_m = 1e-6;  // the triangle that a ray starts on

/// Along a ray of unit direction (Möller and Trumbore 1997); infinite where it
/// misses.
double distance_m(const Triangle& triangle, const Eigen::Vector3d& from_m,
                  const Eigen::Vector3d& direction) {
  const auto& [a, b, c] = triangle.corners_m;
  const Eigen::Vector3d across = direction.cross(c - a);
  const double determinant = across.dot(b - a);
  if (determinant == 0) return kNone;
  const double u = across.dot(from_m - a) / determinant;
  const Eigen::Vector3d up = (from_m - a).cross(b - a);
  const double v = direction.dot(up) / determinant;
  return u < 0 || v < 0 || u + v > 1 ? kNone : up.dot(c - a) / determinant;
}

}  // namespace

std::vector<double> wall_thicknesses_m(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& indices : mesh.triangles) triangles.push_back(triangle_of(mesh, indices));
  const double inwards = signed_volume_m3(mesh) < 0 ? 1 : -1;
  std::vector<double> thicknesses_m;
  visit_surface(mesh, kPoints / surface_area_m2(mesh), [&](const SurfacePoint& point) {
    double nearest_m = kNone;
    for (const Triangle& triangle : triangles) {
      const double s_m = distance_m(triangle, point.position_m.cast<double>(),
                                    inwards * point.normal.cast<double>());
      if (s_m > kItself_m && s_m < nearest_m) nearest_m = s_m;
    }
    thicknesses_m.push_back(nearest_m);
  });
  return thicknesses_m;
}

}  // namespace graspd::parts
