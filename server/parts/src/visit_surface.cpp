#include "visit_surface.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "mesh_geometry.hpp"

namespace graspd::parts {
namespace {

/// The i-th point of Roberts' R2 sequence: powers of 1/g, g the real root of x³ = x + 1.
std::array<double, 2> r2_sequence(std::uint64_t i) {
  constexpr double kG = 1.32471795724474602596;
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto n = static_cast<double>(i);
  return {fraction(0.5 + n / kG), fraction(0.5 + n / (kG * kG))};
}

/// Unit square to triangle, evenly: what lies beyond the diagonal is folded back.
Eigen::Vector3d point_in(const Triangle& triangle, double u, double v) {
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return triangle.corners_m[0] + u * (triangle.corners_m[1] - triangle.corners_m[0]) +
         v * (triangle.corners_m[2] - triangle.corners_m[0]);
}

}  // namespace

void visit_surface(const Mesh& mesh, double points_per_m2,
                   const std::function<void(const SurfacePoint&)>& visit) {
  double area_m2 = 0;
  std::uint64_t i = 0;
  for (const auto& indices : mesh.triangles) {
    const Triangle triangle = triangle_of(mesh, indices);
    const Eigen::Vector3f normal = triangle.area_vector_m2().normalized().cast<float>();
    area_m2 += triangle.area_m2();
    // Counted over the whole surface: triangles too small for a point of their own share one.
    for (; static_cast<double>(i) < points_per_m2 * area_m2; ++i) {
      const auto [u, v] = r2_sequence(i);
      visit({point_in(triangle, u, v).cast<float>(), normal});
    }
  }
}

}  // namespace graspd::parts
