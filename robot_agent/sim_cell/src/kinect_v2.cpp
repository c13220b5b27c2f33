#include "graspd/sim_cell/kinect_v2.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.hpp"

namespace graspd::sim_cell {
namespace {

constexpr double kMaxTheta_rad = 80 * std::numbers::pi / 180;

/// What the pixel's disc of samples sees on average.
struct Footprint {
  double z_m = 0;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::uint16_t id = 0;
};

/// Mean over the samples within the footprint about (u, v), in samples of the fine rendering.
/// Normal and id are those of the sample in the middle.
Footprint average(const Rendering& fine, double u, double v, double radius) {
  double sum_m = 0;
  int count = 0;
  const auto clamp_u = [&](double x) { return std::clamp(static_cast<int>(x), 0, fine.width_px - 1); };
  const auto clamp_v = [&](double y) { return std::clamp(static_cast<int>(y), 0, fine.height_px - 1); };
  for (int y = clamp_v(std::ceil(v - radius)); y <= clamp_v(std::floor(v + radius)); ++y) {
    for (int x = clamp_u(std::ceil(u - radius)); x <= clamp_u(std::floor(u + radius)); ++x) {
      const float z_m = fine.depth_m[fine.index(x, y)];
      if (z_m == 0 || std::hypot(x - u, y - v) > radius) continue;
      sum_m += z_m;
      ++count;
    }
  }
  if (count == 0) return {};
  const std::size_t middle = fine.index(clamp_u(std::round(u)), clamp_v(std::round(v)));
  return {sum_m / count, fine.normal[middle], fine.id[middle]};
}

double multipath_m(const Eigen::Vector3d& p_camera, const Walls& walls,
                   const KinectV2Parameters& parameters) {
  const Eigen::Vector3d p = walls.T_camera_bin.inverse() * p_camera;
  const Eigen::Vector2d to_wall = walls.inner_size_m.head<2>() / 2 - p.head<2>().cwiseAbs();
  const double nearest_m = to_wall.minCoeff();
  const bool inside = nearest_m >= 0 && p.z() < walls.inner_size_m.z();
  if (!inside || nearest_m >= parameters.multipath_reach_m) return 0;
  const double share = 1 - nearest_m / parameters.multipath_reach_m;
  return parameters.multipath_m * share * share;
}

double dropout_share(double theta_rad, double gloss, const KinectV2Parameters& parameters) {
  const double grazing = (theta_rad - parameters.grazing_from_rad) /
                         (std::numbers::pi / 2 - parameters.grazing_from_rad);
  double share = parameters.dropout_share;
  share += parameters.dropout_at_grazing * std::clamp(grazing, 0.0, 1.0);
  if (theta_rad < parameters.glare_half_angle_rad) share += gloss;
  return share;
}

/// One reading in metres, 0 for none.
double reading_m(const Rendering& fine, int u, int v, const std::optional<Walls>& walls,
                 const std::vector<double>& gloss, const KinectV2Parameters& parameters,
                 Random random) {
  const int samples = parameters.oversampling_n;
  const CameraIntrinsics& camera = parameters.camera;
  const double fine_u = samples * (u + 0.5) - 0.5;
  const double fine_v = samples * (v + 0.5) - 0.5;
  const double radius = samples * parameters.footprint_px / 2;
  const Footprint straight = average(fine, fine_u, fine_v, radius);
  if (straight.id == 0 && straight.z_m == 0) return 0;

  const auto [jitter_u, jitter_v] = random.normal_pair();
  const double jitter_px = samples * parameters.lateral_sigma_m * camera.fx_px / straight.z_m;
  const Footprint seen =
      average(fine, fine_u + jitter_px * jitter_u, fine_v + jitter_px * jitter_v, radius);
  if (seen.z_m == 0) return 0;

  const Eigen::Vector3d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px,
                            1);
  const double cosine = -seen.normal.cast<double>().dot(ray.normalized());
  const double theta_rad = std::acos(std::clamp(cosine, 0.0, 1.0));
  const double glossy = seen.id < gloss.size() ? gloss[seen.id] : 0;
  if (random.uniform() < dropout_share(theta_rad, glossy, parameters)) return 0;

  const double sigma_m = parameters.axial_scale * axial_sigma_m(seen.z_m, theta_rad);
  double z_m = seen.z_m + parameters.offset_m + sigma_m * random.normal_pair().first;
  if (walls) z_m += multipath_m(ray * seen.z_m, *walls, parameters);
  return z_m < parameters.min_depth_m || z_m > parameters.max_depth_m ? 0 : z_m;
}

/// As libfreenect2: at a jump of more than the limit within 3 × 3 there is no reading.
void filter_edges(DepthFrame& frame, double limit_m) {
  const CameraIntrinsics& camera = frame.camera;
  const std::vector<std::uint16_t> before = frame.depth;
  const auto limit = static_cast<int>(std::lround(limit_m / frame.depth_scale_m));
  for (int v = 1; v + 1 < camera.height_px; ++v) {
    for (int u = 1; u + 1 < camera.width_px; ++u) {
      int nearest = std::numeric_limits<int>::max();
      int farthest = 0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          const int z = before[static_cast<std::size_t>(v + dv) * camera.width_px + u + du];
          if (z == 0) continue;
          nearest = std::min(nearest, z);
          farthest = std::max(farthest, z);
        }
      }
      if (farthest - nearest > limit) {
        frame.depth[static_cast<std::size_t>(v) * camera.width_px + u] = 0;
      }
    }
  }
}

}  // namespace

double axial_sigma_m(double z_m, double theta_rad) {
  const double theta = std::min(theta_rad, kMaxTheta_rad);
  const double off = std::numbers::pi / 2 - theta;
  const double sigma_mm =
      1.5 - 0.5 * z_m + 0.3 * z_m * z_m + 0.1 * std::pow(z_m, 1.5) * theta * theta / (off * off);
  return sigma_mm * 1e-3;
}

DepthFrame sense(std::span<const PosedMesh> meshes, const std::optional<Walls>& walls,
                 const std::vector<double>& gloss, const KinectV2Parameters& parameters,
                 std::uint64_t seed) {
  const CameraIntrinsics& camera = parameters.camera;
  const Rendering fine = render(oversampled(camera, parameters.oversampling_n), meshes);
  DepthFrame frame{camera, 0.001, {}};
  frame.depth.reserve(static_cast<std::size_t>(camera.width_px) * camera.height_px);
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Random random(seed, frame.depth.size());
      const double z_m = reading_m(fine, u, v, walls, gloss, parameters, random);
      frame.depth.push_back(static_cast<std::uint16_t>(std::lround(z_m / frame.depth_scale_m)));
    }
  }
  filter_edges(frame, parameters.edge_filter_m);
  return frame;
}

}  // namespace graspd::sim_cell
