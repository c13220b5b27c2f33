#include "graspd/simulation/kinect_v2.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gaussian.hpp"
#include "random.hpp"
#include "rays.hpp"

namespace graspd::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSteepest_rad = 80 * kDegree;

/// What becomes a frame, one value per pixel. z is 0 where there is no reading.
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> z_m;
  std::vector<float> cos_incidence;
  std::vector<float> gloss;

  std::size_t size() const { return z_m.size(); }
  double incidence_rad(std::size_t pixel) const {
    return std::acos(std::clamp(double(cos_incidence[pixel]), 0.0, 1.0));
  }
};

// Streams of random numbers: each effect draws from its own, so that switching one off leaves the
// others as they were.
enum Stream : std::uint64_t { kLateral = 1, kAxial = 2, kDropOut = 3 };

Random pixel_random(std::uint64_t seed, Stream effect, std::size_t pixel) {
  return Random(seed + 0x1000193 * effect, pixel);
}

/// What a sensor sees of a scene, and how.
struct Drawing {
  const Rendering& fine;
  const std::vector<float>& cos_incidence;
  const std::vector<float>& gloss;
};

/// Mean over a square of fine pixels; no reading where most of it sees nothing.
void average_footprint(const Drawing& drawing, const Eigen::Vector2d& centre_px, int n,
                       std::size_t pixel, Image& image) {
  double z_m = 0, cosine = 0, gloss = 0;
  int hits_n = 0;
  const Rendering& fine = drawing.fine;
  const int u_first = int(std::lround(centre_px.x() - (n - 1) / 2.0));
  const int v_first = int(std::lround(centre_px.y() - (n - 1) / 2.0));
  for (int v = v_first; v < v_first + n; ++v) {
    for (int u = u_first; u < u_first + n; ++u) {
      if (u < 0 || v < 0 || u >= fine.camera.width_px || v >= fine.camera.height_px) continue;
      const std::size_t i = fine.index(u, v);
      if (fine.object[i] == Rendering::kNothing) continue;
      cosine += double(drawing.cos_incidence[i]);
      z_m += double(fine.z_m[i]);
      gloss += double(drawing.gloss[i]);
      ++hits_n;
    }
  }
  if (2 * hits_n <= n * n) return;
  image.z_m[pixel] = float(z_m / hits_n);
  image.cos_incidence[pixel] = float(cosine / hits_n);
  image.gloss[pixel] = float(gloss / hits_n);
}

Image sample(const Drawing& drawing, const std::vector<Eigen::Vector3d>& rays,
             const KinectV2Parameters& sensor, std::uint64_t seed) {
  const Rendering& fine = drawing.fine;
  Image image{sensor.camera.width_px, sensor.camera.height_px, {}, {}, {}};
  for (auto* channel : {&image.z_m, &image.cos_incidence, &image.gloss}) {
    channel->assign(rays.size(), 0);
  }
  for (std::size_t pixel = 0; pixel < rays.size(); ++pixel) {
    const Eigen::Vector2d uv = project(fine.camera, rays[pixel]);
    const auto straight = fine.index(int(std::lround(uv.x())), int(std::lround(uv.y())));
    // The jitter has a size in metres: what it is in pixels depends on how far the ray goes.
    const double z_m = double(fine.z_m[straight]);
    const double sigma_px = z_m > 0 ? sensor.lateral_sigma_m / z_m * fine.camera.fx_px : 0;
    const auto [du, dv] = pixel_random(seed, kLateral, pixel).normal_pair();
    average_footprint(drawing, uv + sigma_px * Eigen::Vector2d(du, dv), sensor.rays_per_side_n,
                      pixel, image);
  }
  return image;
}

void bend_towards_walls(const KinectV2Parameters& sensor, const Walls& walls,
                        const std::vector<Eigen::Vector3d>& rays, Image& image) {
  const Eigen::Isometry3d T_bin_camera = walls.T_camera_bin.inverse();
  const Eigen::Vector2d half_m = walls.inner_size_m.head<2>() / 2;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (image.z_m[i] <= 0) continue;
    const Eigen::Vector3d p_m = T_bin_camera * (double(image.z_m[i]) * rays[i]);
    const double distance_m = (half_m - p_m.head<2>().cwiseAbs()).minCoeff();
    if (distance_m < 0 || p_m.z() > walls.inner_size_m.z()) continue;  // rim and outside
    const double nearness = std::max(0.0, 1 - distance_m / sensor.wall_reach_m);
    image.z_m[i] -= float(sensor.wall_bow_m * nearness * nearness);
  }
}

/// Adds white noise and then smooths it together with the depth. The noise is made larger
/// beforehand by what the smoothing takes away.
void add_noise_and_blur(const KinectV2Parameters& sensor, std::uint64_t seed, Image& image) {
  const std::vector<float> kernel = gaussian_kernel(sensor.blur_sigma_px);
  double kernel_energy = 0;
  for (const float weight : kernel) kernel_energy += double(weight) * double(weight);
  std::vector<float> weight(image.size(), 0);
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (image.z_m[i] <= 0) continue;
    weight[i] = 1;
    const double sigma_m = sensor.axial_scale *
                           axial_sigma_m(double(image.z_m[i]), image.incidence_rad(i)) /
                           kernel_energy;  // of both directions: the root of its square
    image.z_m[i] += float(sigma_m * pixel_random(seed, kAxial, i).normal_pair().first);
  }
  const auto sum = convolve(image.z_m, image.width_px, image.height_px, kernel);
  const auto total = convolve(weight, image.width_px, image.height_px, kernel);
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (weight[i] > 0) image.z_m[i] = sum[i] / total[i];
  }
}

double drop_out_probability(const KinectV2Parameters& sensor, double incidence_rad, double gloss) {
  const auto ramp = [](double x, double from, double to) {
    return std::clamp((x - from) / (to - from), 0.0, 1.0);
  };
  const double grazing = sensor.grazing_drop_out * ramp(incidence_rad, kSteepest_rad, 90 * kDegree);
  // A polished surface blinds the sensor where it faces it, and sends the light elsewhere where it
  // leans away.
  const double blinded = gloss * (1 - ramp(incidence_rad, 2 * kDegree, 6 * kDegree));
  const double sent_away = gloss * ramp(incidence_rad, 40 * kDegree, 80 * kDegree);
  return std::max({grazing, blinded, sent_away});
}

void drop_out(const KinectV2Parameters& sensor, std::uint64_t seed, Image& image) {
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double probability =
        drop_out_probability(sensor, image.incidence_rad(i), double(image.gloss[i]));
    if (pixel_random(seed, kDropOut, i).uniform() < probability) image.z_m[i] = 0;
  }
}

void filter_edges(const KinectV2Parameters& sensor, Image& image) {
  if (!(sensor.edge_filter_m > 0)) return;
  std::vector<float> kept = image.z_m;
  const int width = image.width_px;
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < width; ++u) {
      float nearest_m = std::numeric_limits<float>::max(), farthest_m = 0;
      for (int y = std::max(0, v - 1); y <= std::min(image.height_px - 1, v + 1); ++y) {
        for (int x = std::max(0, u - 1); x <= std::min(width - 1, u + 1); ++x) {
          const float z_m = image.z_m[std::size_t(y) * std::size_t(width) + std::size_t(x)];
          if (z_m <= 0) continue;
          nearest_m = std::min(nearest_m, z_m);
          farthest_m = std::max(farthest_m, z_m);
        }
      }
      if (farthest_m - nearest_m > float(sensor.edge_filter_m)) {
        kept[std::size_t(v) * std::size_t(width) + std::size_t(u)] = 0;
      }
    }
  }
  image.z_m = std::move(kept);
}

DepthFrame quantise(const KinectV2Parameters& sensor, const Image& image) {
  DepthFrame frame{sensor.camera, sensor.depth_scale_m, {}};
  frame.depth.reserve(image.size());
  for (const float z_m : image.z_m) {
    const double reading_m = double(z_m) + sensor.device_offset_m;
    const bool readable =
        z_m > 0 && reading_m >= sensor.min_depth_m && reading_m <= sensor.max_depth_m;
    frame.depth.push_back(readable ? std::uint16_t(std::lround(reading_m / sensor.depth_scale_m))
                                   : std::uint16_t(0));
  }
  return frame;
}

}  // namespace

double axial_sigma_m(double z_m, double incidence_rad) {
  const double theta = std::clamp(incidence_rad, 0.0, kSteepest_rad);
  const double to_grazing = std::numbers::pi / 2 - theta;
  const double sigma_mm = 1.5 - 0.5 * z_m + 0.3 * z_m * z_m +
                          0.1 * std::pow(z_m, 1.5) * theta * theta / (to_grazing * to_grazing);
  return sigma_mm * 1e-3;
}

StillScene::StillScene(std::span<const SceneObject> scene, const KinectV2Parameters& sensor,
                       const std::optional<Walls>& walls)
    : sensor_(sensor),
      walls_(walls),
      rays_(pixel_rays(sensor.camera)),
      fine_(render(rectified_camera(sensor.camera, rays_, sensor.rays_per_side_n), scene)),
      cos_incidence_(fine_.object.size(), 0),
      gloss_(fine_.object.size(), 0) {
  const CameraIntrinsics& camera = fine_.camera;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const std::size_t i = fine_.index(u, v);
      if (fine_.object[i] == Rendering::kNothing) continue;
      const Eigen::Vector3f ray(float((u - camera.cx_px) / camera.fx_px),
                                float((v - camera.cy_px) / camera.fy_px), 1);
      cos_incidence_[i] = -fine_.facet_normals[std::size_t(fine_.facet[i])].dot(ray) / ray.norm();
      gloss_[i] = float(scene[std::size_t(fine_.object[i])].gloss);
    }
  }
}

DepthFrame StillScene::look(std::uint64_t seed) const {
  Image image = sample({fine_, cos_incidence_, gloss_}, rays_, sensor_, seed);
  if (walls_) bend_towards_walls(sensor_, *walls_, rays_, image);
  add_noise_and_blur(sensor_, seed, image);
  drop_out(sensor_, seed, image);
  filter_edges(sensor_, image);
  return quantise(sensor_, image);
}

DepthFrame observe(std::span<const SceneObject> scene, const KinectV2Parameters& sensor,
                   std::uint64_t seed, const Walls* walls) {
  const auto given = walls != nullptr ? std::optional(*walls) : std::nullopt;
  return StillScene(scene, sensor, given).look(seed);
}

}  // namespace graspd::simulation
