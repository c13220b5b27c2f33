#include "graspd/simulation/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "rays.hpp"

namespace graspd::simulation {
namespace {

constexpr double kNear_m = 0.01;
/// Rounding must not open a crack between two triangles.
constexpr double kEdge = 1e-9;
/// Of the rectified image behind a distorted one.
constexpr int kRaysPerSide = 3;

/// A corner in the image. Its inverse depth, unlike its depth, is linear across the image.
struct ImagePoint {
  double u = 0;
  double v = 0;
  double inverse_z = 0;
};

class Rasteriser {
 public:
  explicit Rasteriser(Rendering& rendering) : out_(rendering) {}

  void draw(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            std::int32_t object) {
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (!(normal.squaredNorm() > 0)) return;
    std::array<Eigen::Vector3d, 4> corners;
    const int corners_n = clip_near({a, b, c}, corners);
    if (corners_n < 3) return;
    const double side = normal.dot(a) > 0 ? -1 : 1;
    const auto facet = std::int32_t(out_.facet_normals.size());
    out_.facet_normals.push_back((side * normal.normalized()).cast<float>());
    for (int i = 2; i < corners_n; ++i) {
      fill(project(corners[0]), project(corners[i - 1]), project(corners[i]), object, facet);
    }
  }

 private:
  /// The part of a triangle beyond the near plane: 0, 3 or 4 corners.
  static int clip_near(const std::array<Eigen::Vector3d, 3>& triangle,
                       std::array<Eigen::Vector3d, 4>& clipped) {
    int n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = triangle[i];
      const Eigen::Vector3d& q = triangle[(i + 1) % 3];
      if (p.z() >= kNear_m) clipped[n++] = p;
      if ((p.z() < kNear_m) != (q.z() < kNear_m)) {
        clipped[n++] = p + (q - p) * ((kNear_m - p.z()) / (q.z() - p.z()));
      }
    }
    return n;
  }

  ImagePoint project(const Eigen::Vector3d& p) const {
    const CameraIntrinsics& camera = out_.camera;
    return {camera.fx_px * p.x() / p.z() + camera.cx_px,
            camera.fy_px * p.y() / p.z() + camera.cy_px, 1 / p.z()};
  }

  void fill(ImagePoint a, ImagePoint b, ImagePoint c, std::int32_t object, std::int32_t facet) {
    double area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    if (area < 0) {
      std::swap(b, c);
      area = -area;
    }
    if (!(area > 0)) return;
    const int u_first = first_pixel(std::min({a.u, b.u, c.u}));
    const int v_first = first_pixel(std::min({a.v, b.v, c.v}));
    const int u_last = last_pixel(std::max({a.u, b.u, c.u}), out_.camera.width_px);
    const int v_last = last_pixel(std::max({a.v, b.v, c.v}), out_.camera.height_px);

    // Barycentric weights grow by the same step from pixel to pixel.
    const double b_u = (c.v - a.v) / area, b_v = -(c.u - a.u) / area;
    const double c_u = -(b.v - a.v) / area, c_v = (b.u - a.u) / area;
    const double inverse_z_u =
        b_u * (b.inverse_z - a.inverse_z) + c_u * (c.inverse_z - a.inverse_z);
    for (int v = v_first; v <= v_last; ++v) {
      const double du = u_first - a.u, dv = v - a.v;
      double weight_b = b_u * du + b_v * dv;
      double weight_c = c_u * du + c_v * dv;
      double inverse_z = a.inverse_z + weight_b * (b.inverse_z - a.inverse_z) +
                         weight_c * (c.inverse_z - a.inverse_z);
      std::size_t pixel = out_.index(u_first, v);
      for (int u = u_first; u <= u_last; ++u, ++pixel) {
        if (weight_b >= -kEdge && weight_c >= -kEdge && weight_b + weight_c <= 1 + kEdge) {
          const auto z_m = float(1 / inverse_z);
          if (out_.object[pixel] == Rendering::kNothing || z_m < out_.z_m[pixel]) {
            out_.z_m[pixel] = z_m;
            out_.object[pixel] = object;
            out_.facet[pixel] = facet;
          }
        }
        weight_b += b_u;
        weight_c += c_u;
        inverse_z += inverse_z_u;
      }
    }
  }

  static int first_pixel(double lowest) { return int(std::ceil(std::clamp(lowest, 0.0, 1e6))); }
  static int last_pixel(double highest, int side_px) {
    return int(std::floor(std::clamp(highest, -1.0, double(side_px - 1))));
  }

  Rendering& out_;
};

Rendering render_rectified(const CameraIntrinsics& camera, std::span<const SceneObject> objects) {
  Rendering rendering;
  rendering.camera = camera;
  const std::size_t pixels_n = std::size_t(camera.width_px) * std::size_t(camera.height_px);
  rendering.z_m.assign(pixels_n, 0);
  rendering.object.assign(pixels_n, Rendering::kNothing);
  rendering.facet.assign(pixels_n, Rendering::kNothing);

  Rasteriser rasteriser(rendering);
  std::vector<Eigen::Vector3d> vertices_m;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    vertices_m.clear();
    for (const Eigen::Vector3f& vertex : object.mesh->vertices_m) {
      vertices_m.push_back(object.T_camera_object * vertex.cast<double>());
    }
    for (const auto& [a, b, c] : object.mesh->triangles) {
      rasteriser.draw(vertices_m[std::size_t(a)], vertices_m[std::size_t(b)],
                      vertices_m[std::size_t(c)], std::int32_t(i));
    }
  }
  return rendering;
}

/// Each of the camera's rays reads the nearest pixel of a finer, rectified image.
Rendering resample(Rendering fine, const CameraIntrinsics& camera,
                   const std::vector<Eigen::Vector3d>& rays) {
  Rendering rendering;
  rendering.camera = camera;
  for (const Eigen::Vector3d& ray : rays) {
    const Eigen::Vector2d uv = project(fine.camera, ray);
    const std::size_t i = fine.index(int(std::lround(uv.x())), int(std::lround(uv.y())));
    rendering.z_m.push_back(fine.z_m[i]);
    rendering.object.push_back(fine.object[i]);
    rendering.facet.push_back(fine.facet[i]);
  }
  rendering.facet_normals = std::move(fine.facet_normals);
  return rendering;
}

}  // namespace

Rendering render(const CameraIntrinsics& camera, std::span<const SceneObject> objects) {
  if (camera.distortion == std::array<double, 5>{}) return render_rectified(camera, objects);
  const std::vector<Eigen::Vector3d> rays = pixel_rays(camera);
  return resample(render_rectified(rectified_camera(camera, rays, kRaysPerSide), objects), camera,
                  rays);
}

std::vector<double> visible_fractions(const Rendering& rendering,
                                      std::span<const SceneObject> objects) {
  std::vector<std::size_t> seen_n(objects.size(), 0);
  for (const std::int32_t object : rendering.object) {
    if (object != Rendering::kNothing) ++seen_n[std::size_t(object)];
  }
  std::vector<double> fractions;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Rendering alone = render(rendering.camera, objects.subspan(i, 1));
    const auto alone_n = std::count(alone.object.begin(), alone.object.end(), 0);
    fractions.push_back(alone_n > 0 ? double(seen_n[i]) / double(alone_n) : 0);
  }
  return fractions;
}

}  // namespace graspd::simulation
