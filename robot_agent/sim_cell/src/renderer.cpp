#include "graspd/sim_cell/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace graspd::sim_cell {
namespace {

struct ScreenVertex {
  float u_px, v_px;
  float inverse_z;
};

float edge(const ScreenVertex& a, const ScreenVertex& b, float u, float v) {
  return (b.u_px - a.u_px) * (v - a.v_px) - (b.v_px - a.v_px) * (u - a.u_px);
}

/// 1/z is linear in the image plane, so it is what is interpolated.
void draw(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
          const Eigen::Vector3f& normal, std::uint16_t id, Rendering& target) {
  const float area = edge(a, b, c.u_px, c.v_px);
  if (area == 0) return;
  const auto low = [](float x, float y, float z) { return std::ceil(std::min({x, y, z})); };
  const auto high = [](float x, float y, float z) { return std::floor(std::max({x, y, z})); };
  const int u_first = std::max(0, static_cast<int>(low(a.u_px, b.u_px, c.u_px)));
  const int v_first = std::max(0, static_cast<int>(low(a.v_px, b.v_px, c.v_px)));
  const int u_last = std::min(target.width_px - 1, static_cast<int>(high(a.u_px, b.u_px, c.u_px)));
  const int v_last = std::min(target.height_px - 1, static_cast<int>(high(a.v_px, b.v_px, c.v_px)));
  for (int v = v_first; v <= v_last; ++v) {
    for (int u = u_first; u <= u_last; ++u) {
      const auto x = static_cast<float>(u);
      const auto y = static_cast<float>(v);
      const float wa = edge(b, c, x, y) / area;
      const float wb = edge(c, a, x, y) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const float z_m = 1 / (wa * a.inverse_z + wb * b.inverse_z + wc * c.inverse_z);
      const std::size_t i = target.index(u, v);
      if (target.depth_m[i] != 0 && target.depth_m[i] <= z_m) continue;
      target.depth_m[i] = z_m;
      target.id[i] = id;
      target.normal[i] = normal;
    }
  }
}

void draw(const CameraIntrinsics& camera, const PosedMesh& posed, Rendering& target) {
  const Eigen::Isometry3f T = posed.T_camera_mesh.cast<float>();
  std::vector<Eigen::Vector3f> points_m;
  std::vector<ScreenVertex> screen;
  for (const auto& vertex : posed.mesh->vertices_m) {
    const Eigen::Vector3f p = T * vertex;
    points_m.push_back(p);
    screen.push_back(
        {static_cast<float>(camera.fx_px) * p.x() / p.z() + static_cast<float>(camera.cx_px),
         static_cast<float>(camera.fy_px) * p.y() / p.z() + static_cast<float>(camera.cy_px),
         1 / p.z()});
  }
  for (const auto& [a, b, c] : posed.mesh->triangles) {
    const float nearest_m = std::min({points_m[a].z(), points_m[b].z(), points_m[c].z()});
    if (nearest_m < kNearPlane_m) continue;
    Eigen::Vector3f normal =
        (points_m[b] - points_m[a]).cross(points_m[c] - points_m[a]).normalized();
    if (normal.dot(points_m[a]) > 0) normal = -normal;
    draw(screen[a], screen[b], screen[c], normal, posed.id, target);
  }
}

Rendering empty(const CameraIntrinsics& camera) {
  Rendering rendering{camera.width_px, camera.height_px, {}, {}, {}};
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  rendering.depth_m.assign(pixels, 0);
  rendering.id.assign(pixels, 0);
  rendering.normal.assign(pixels, Eigen::Vector3f::Zero());
  return rendering;
}

}  // namespace

Rendering render(const CameraIntrinsics& camera, std::span<const PosedMesh> meshes) {
  Rendering rendering = empty(camera);
  for (const PosedMesh& mesh : meshes) draw(camera, mesh, rendering);
  return rendering;
}

CameraIntrinsics oversampled(const CameraIntrinsics& camera, int factor) {
  CameraIntrinsics fine = camera;
  fine.width_px *= factor;
  fine.height_px *= factor;
  fine.fx_px *= factor;
  fine.fy_px *= factor;
  // Pixel centres are at whole numbers: a pixel's samples lie evenly about its centre.
  fine.cx_px = factor * (camera.cx_px + 0.5) - 0.5;
  fine.cy_px = factor * (camera.cy_px + 0.5) - 0.5;
  return fine;
}

std::vector<double> visible_fractions(const CameraIntrinsics& camera,
                                      std::span<const PosedMesh> meshes,
                                      const Rendering& rendering) {
  std::map<std::uint16_t, std::size_t> visible_n;
  for (const std::uint16_t id : rendering.id) ++visible_n[id];
  std::vector<double> fractions;
  for (const PosedMesh& mesh : meshes) {
    const Rendering alone = render(camera, {&mesh, 1});
    const auto whole_n = std::count_if(alone.depth_m.begin(), alone.depth_m.end(),
                                       [](float z_m) { return z_m > 0; });
    const auto seen_n = static_cast<double>(visible_n[mesh.id]);
    fractions.push_back(whole_n == 0 ? 0 : std::min(1.0, seen_n / static_cast<double>(whole_n)));
  }
  return fractions;
}

}  // namespace graspd::sim_cell
