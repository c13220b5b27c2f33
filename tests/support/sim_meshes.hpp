#pragma once

#include <cmath>
#include <numbers>

#include "graspd/parts/mesh.hpp"

/// Meshes with known geometry, centred at the origin.
namespace graspd::testing {

inline parts::Mesh box_mesh(const Eigen::Vector3d& size_m) {
  parts::Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices_m.push_back(size_m.cwiseProduct(sign).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A square in the plane z = 0, of n × n cells with two triangles each.
inline parts::Mesh square_mesh(double side_m, int n = 1) {
  parts::Mesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      mesh.vertices_m.emplace_back(static_cast<float>(side_m * (double(i) / n - 0.5)),
                                   static_cast<float>(side_m * (double(j) / n - 0.5)), 0.0F);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 1});
      mesh.triangles.push_back({a + 1, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

/// A pipe along z, open at both ends.
inline parts::Mesh pipe_mesh(double outer_radius_m, double inner_radius_m, double length_m,
                             int sides = 48) {
  parts::Mesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    for (const double radius_m : {outer_radius_m, inner_radius_m}) {
      for (const double z_m : {-length_m / 2, length_m / 2}) {
        mesh.vertices_m.push_back(
            Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), z_m)
                .cast<float>());
      }
    }
  }
  const auto quad = [&mesh](int a, int b, int c, int d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < sides; ++i) {
    const int a = 4 * i, b = 4 * ((i + 1) % sides);  // outer low, outer high, inner low, inner high
    quad(a, b, b + 1, a + 1);
    quad(a + 2, a + 3, b + 3, b + 2);
    quad(a + 1, b + 1, b + 3, a + 3);
    quad(a, a + 2, b + 2, b);
  }
  return mesh;
}

inline parts::Mesh sphere_mesh(double radius_m, int rings = 96) {
  parts::Mesh mesh;
  const int sides = 2 * rings;
  for (int j = 0; j <= rings; ++j) {
    const double theta = std::numbers::pi * j / rings;
    for (int i = 0; i < sides; ++i) {
      const double phi = 2 * std::numbers::pi * i / sides;
      mesh.vertices_m.push_back(
          (radius_m * Eigen::Vector3d(std::sin(theta) * std::cos(phi),
                                      std::sin(theta) * std::sin(phi), std::cos(theta)))
              .cast<float>());
    }
  }
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < sides; ++i) {
      const int a = j * sides + i, b = j * sides + (i + 1) % sides;
      mesh.triangles.push_back({a, a + sides, b});
      mesh.triangles.push_back({b, a + sides, b + sides});
    }
  }
  return mesh;
}

}  // namespace graspd::testing
