#include "shape_mesh.hpp"

#include <cmath>

namespace graspd::sim_cell {
namespace {

constexpr int kSides = 24;
constexpr int kRings = 12;

/// Turns a profile, from the lowest point on the axis to the highest, about z.
parts::Mesh turned(const std::vector<Eigen::Vector2d>& radius_z_m) {
  parts::Mesh mesh;
  for (const Eigen::Vector2d& p : radius_z_m) {
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * M_PI * i / kSides;
      const Eigen::Vector3d vertex(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
      mesh.vertices_m.push_back(vertex.cast<float>());
    }
  }
  const auto rings_n = static_cast<int>(radius_z_m.size());
  for (int ring = 1; ring < rings_n; ++ring) {
    for (int i = 0; i < kSides; ++i) {
      const int a = (ring - 1) * kSides + i, b = (ring - 1) * kSides + (i + 1) % kSides;
      mesh.triangles.push_back({a, b, b + kSides});
      mesh.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
  return mesh;
}

struct MakeMesh {
  parts::Mesh operator()(const motion::Box& box) const {
    const Eigen::Vector3d half_m = box.size_m / 2;
    parts::Mesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                 (corner & 4) != 0 ? 1 : -1);
      mesh.vertices_m.push_back(half_m.cwiseProduct(sign).cast<float>());
    }
    for (const auto& [a, b, c, d] :
         {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
          std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
    return mesh;
  }
  parts::Mesh operator()(const motion::Cylinder& cylinder) const {
    const double r_m = cylinder.radius_m, z_m = cylinder.length_m / 2;
    return turned({{0, -z_m}, {r_m, -z_m}, {r_m, z_m}, {0, z_m}});
  }
  parts::Mesh operator()(const motion::Sphere& sphere) const {
    std::vector<Eigen::Vector2d> profile;
    for (int ring = 0; ring <= kRings; ++ring) {
      const double angle = M_PI * ring / kRings;
      profile.emplace_back(sphere.radius_m * std::sin(angle), -sphere.radius_m * std::cos(angle));
    }
    return turned(profile);
  }
};

}  // namespace

parts::Mesh mesh_of(const motion::Shape& shape) { return std::visit(MakeMesh{}, shape); }

}  // namespace graspd::sim_cell
