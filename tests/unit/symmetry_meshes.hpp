#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/parts/mesh_check.hpp"

/// Solids whose turns are known from their making, and other triangles for the same surface.
namespace graspd::parts {

/// Radius over the angle about z, for outlines that the z axis sees all of.
using Outline = std::function<double(double angle_rad)>;

inline Outline circle(double radius_m) {
  return [=](double) { return radius_m; };
}

/// Stands on z = 0; bottom and top are joined corner by corner, `twist_rad` further at the top.
inline Mesh loft_mesh(int corners_n, const Outline& bottom_m, const Outline& top_m, double height_m,
                      double twist_rad = 0) {
  Mesh mesh;
  const auto add = [&mesh](double radius_m, double angle_rad, double z_m) {
    mesh.vertices_m.push_back(
        Eigen::Vector3d(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), z_m)
            .cast<float>());
  };
  for (int i = 0; i < corners_n; ++i) {
    const double angle_rad = 2 * std::numbers::pi * i / corners_n;
    add(bottom_m(angle_rad), angle_rad, 0);
    add(top_m(angle_rad), angle_rad + twist_rad, height_m);
  }
  add(0, 0, 0);
  add(0, 0, height_m);
  const int bottom = 2 * corners_n;
  for (int i = 0; i < corners_n; ++i) {
    const int a = 2 * i;
    const int b = 2 * ((i + 1) % corners_n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({bottom, b, a});
    mesh.triangles.push_back({bottom + 1, a + 1, b + 1});
  }
  return mesh;
}

inline Mesh prism_mesh(int corners_n, double radius_m, double height_m) {
  return loft_mesh(corners_n, circle(radius_m), circle(radius_m), height_m);
}

/// A wheel of teeth of rectangular or, where `is_ratchet`, saw-tooth outline.
inline Mesh gear_mesh(int teeth_n, double radius_m, double depth_m, double height_m,
                      bool is_ratchet = false) {
  const Outline outline = [=](double angle_rad) {
    const double turns = angle_rad * teeth_n / (2 * std::numbers::pi) + 1e-9;
    const double phase = turns - std::floor(turns);
    return radius_m - depth_m * (is_ratchet ? phase : std::floor(2 * phase));
  };
  return loft_mesh(8 * teeth_n, outline, outline, height_m);
}

/// Convex, corners as given; each face's corners counter-clockwise from outside.
inline Mesh tetrahedron_mesh(double size_m) {
  Mesh mesh;
  const auto s = static_cast<float>(size_m / 2);
  mesh.vertices_m = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

inline Mesh icosahedron_mesh(double size_m) {
  Mesh mesh;
  const auto a = static_cast<float>(size_m / 2);
  const auto b = static_cast<float>(size_m / 2 * std::numbers::phi);
  mesh.vertices_m = {{-a, b, 0},  {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                     {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

/// The same surface of other triangles, unevenly: any triangle may be split at any place.
inline Mesh resplit(Mesh mesh, std::mt19937& random, std::size_t triangles_n) {
  std::uniform_real_distribution<float> uniform(0.1F, 1.0F);
  while (mesh.triangles.size() < triangles_n) {
    const std::size_t i = random() % mesh.triangles.size();
    const auto [a, b, c] = mesh.triangles[i];
    const float u = uniform(random);
    const float v = uniform(random);
    const float w = uniform(random);
    const auto vertex = [&mesh](int k) { return mesh.vertices_m[static_cast<std::size_t>(k)]; };
    const int d = static_cast<int>(mesh.vertices_m.size());
    mesh.vertices_m.emplace_back((u * vertex(a) + v * vertex(b) + w * vertex(c)) / (u + v + w));
    mesh.triangles[i] = {a, b, d};
    mesh.triangles.push_back({b, c, d});
    mesh.triangles.push_back({c, a, d});
  }
  return mesh;
}

/// Three vertices for each triangle, as a careless exporter writes them.
inline Mesh exploded(const Mesh& mesh) {
  Mesh result;
  for (const auto& triangle : mesh.triangles) {
    const int first = static_cast<int>(result.vertices_m.size());
    for (const int index : triangle) {
      result.vertices_m.push_back(mesh.vertices_m[static_cast<std::size_t>(index)]);
    }
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

inline Mesh with_noise(Mesh mesh, std::mt19937& random, double amplitude_m) {
  std::uniform_real_distribution<double> uniform(-amplitude_m, amplitude_m);
  for (auto& vertex_m : mesh.vertices_m) {
    for (float& value : vertex_m) value += static_cast<float>(uniform(random));
  }
  return mesh;
}

inline double squared_distance(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                               const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const auto to_segment = [&p](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    const Eigen::Vector3f d = to - from;
    const float s = std::clamp((p - from).dot(d) / d.squaredNorm(), 0.0F, 1.0F);
    return (p - from - s * d).squaredNorm();
  };
  const Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
  const bool is_above = (b - a).cross(p - a).dot(normal) >= 0 &&
                        (c - b).cross(p - b).dot(normal) >= 0 &&
                        (a - c).cross(p - c).dot(normal) >= 0;
  const float height = (p - a).dot(normal);
  return is_above ? height * height
                  : std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

/// From a point to the surface: looks at every triangle.
inline double distance_m(const Mesh& mesh, const Eigen::Vector3f& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    best = std::min(best, squared_distance(p, mesh.vertices_m[static_cast<std::size_t>(a)],
                                           mesh.vertices_m[static_cast<std::size_t>(b)],
                                           mesh.vertices_m[static_cast<std::size_t>(c)]));
  }
  return std::sqrt(best);
}

/// What `grasp_server part check` says of the mesh's symmetries.
inline std::string symmetries_line(const Mesh& mesh) {
  for (const MeshFinding& finding : check_mesh(mesh, {})) {
    if (finding.topic == "symmetries") return finding.sentence;
  }
  return {};
}

}  // namespace graspd::parts
