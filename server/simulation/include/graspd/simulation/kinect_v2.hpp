#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graspd/simulation/render.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::simulation {

/// A Kinect v2 as its drivers deliver it: time-of-flight depth after libfreenect2's filters. The
/// sources of the numbers are
///   [F] Fankhauser et al., Kinect v2 for Mobile Robot Navigation, ICAR 2015;
///   [L] libfreenect2, depth packet processor;
///   [R] fitted to a real frame by tests/bench/sensor_comparison: a bin with four pipe tees.
/// Set a share, a sigma or a probability to 0 to switch its effect off.
struct KinectV2Parameters {
  CameraIntrinsics camera{512, 424, 365.5, 365.5, 255, 205, {}};
  double depth_scale_m = 0.001;  ///< whole millimetres, as the driver gives them
  double min_depth_m = 0.5;
  double max_depth_m = 4.5;

  /// Rays per pixel side. A pixel reads the mean depth of its footprint, so that pixels on an edge
  /// float between front and back.
  int rays_per_side_n = 3;
  /// [R] Lens and the driver's smoothing. It also makes the noise of neighbours alike.
  double blur_sigma_px = 0.9;

  /// [R] Jitter of each pixel's ray, across the line of sight. [F] gives 0.0016 for the places of
  /// edges, which is mostly the pixel's own size: with that, edges are twice as rough as real ones.
  double lateral_sigma_m = 0.0004;
  /// [R] Times `axial_sigma_m`.
  double axial_scale = 1.08;

  /// [R] Multipath: light that also comes by way of a wall bends surfaces up towards it, by
  /// wall_bow_m · (1 − d / wall_reach_m)² at the distance d from the nearest wall.
  double wall_bow_m = 0.0075;
  double wall_reach_m = 0.075;

  double device_offset_m = 0;  ///< up to 0.024 from device to device [F]

  /// [R] Probability of no reading where the ray only grazes a surface; grows from 80° to 90°.
  double grazing_drop_out = 0.1;
  /// [L] No reading where the 3×3 neighbourhood spans more than this.
  double edge_filter_m = 0.1;
};

/// [F] σ in metres of a reading at depth z, the ray at this angle to the surface normal:
/// 1.5 − 0.5 z + 0.3 z² + 0.1 z^1.5 θ² / (π/2 − θ)² millimetres, z in metres. θ is held below 80°,
/// where the formula was measured.
double axial_sigma_m(double z_m, double incidence_rad);

/// The inner walls of a bin, for multipath. z up, origin in the middle of its floor.
struct Walls {
  Eigen::Isometry3d T_camera_bin = Eigen::Isometry3d::Identity();
  Eigen::Vector3d inner_size_m = Eigen::Vector3d::Zero();
};

/// What such a sensor has before it: drawn once, looked at any number of times.
class StillScene {
 public:
  /// \param walls of the bin; none where there is none: no multipath then. With distortion
  /// coefficients in `sensor.camera` every pixel looks along its own, distorted ray.
  StillScene(std::span<const SceneObject> scene, const KinectV2Parameters& sensor,
             const std::optional<Walls>& walls);

  /// One frame. The same scene, sensor and seed give the same bytes.
  DepthFrame look(std::uint64_t seed) const;

 private:
  KinectV2Parameters sensor_;
  std::optional<Walls> walls_;
  std::vector<Eigen::Vector3d> rays_;
  Rendering fine_;  ///< several rays a pixel side, without distortion
  // Of the drawing's pixels that see something.
  std::vector<float> cos_incidence_;
  std::vector<float> gloss_;
};

/// A single look at a scene. \param walls of the bin, or nullptr where there is none.
DepthFrame observe(std::span<const SceneObject> scene, const KinectV2Parameters& sensor,
                   std::uint64_t seed, const Walls* walls = nullptr);

}  // namespace graspd::simulation
