#include "graspd/simulation/bin_mesh.hpp"

namespace graspd::simulation {
namespace {

constexpr double kTableHalf_m = 1.5;
constexpr double kTableThickness_m = 0.01;

void add_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, parts::Mesh& mesh) {
  const auto first = static_cast<int>(mesh.vertices_m.size());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p((corner & 1) != 0 ? high_m.x() : low_m.x(),
                            (corner & 2) != 0 ? high_m.y() : low_m.y(),
                            (corner & 4) != 0 ? high_m.z() : low_m.z());
    mesh.vertices_m.push_back(p.cast<float>());
  }
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& face : kFaces) {
    mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
  }
}

}  // namespace

parts::Mesh bin_mesh(const Eigen::Vector3d& inner_size_m, double wall_m) {
  const double x = inner_size_m.x() / 2;
  const double y = inner_size_m.y() / 2;
  parts::Mesh mesh;
  add_box({-kTableHalf_m, -kTableHalf_m, -kTableThickness_m}, {kTableHalf_m, kTableHalf_m, 0},
          mesh);
  add_box({-x - wall_m, -y - wall_m, 0}, {-x, y + wall_m, inner_size_m.z()}, mesh);
  add_box({x, -y - wall_m, 0}, {x + wall_m, y + wall_m, inner_size_m.z()}, mesh);
  add_box({-x, -y - wall_m, 0}, {x, -y, inner_size_m.z()}, mesh);
  add_box({-x, y, 0}, {x, y + wall_m, inner_size_m.z()}, mesh);
  return mesh;
}

}  // namespace graspd::simulation
