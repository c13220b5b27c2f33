#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graspd/sim_cell/renderer.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::sim_cell {

/// A Kinect v2's errors: Fankhauser et al. 2015 for the noise, and what real frames show.
struct KinectV2Parameters {
  CameraIntrinsics camera{512, 424, 365.5, 365.5, 255, 205, {}};
  double min_depth_m = 0.5;
  double max_depth_m = 4.5;
  /// A pixel's light comes from a disc about a pixel wide: readings at an edge lie between both
  /// sides and fly.
  int oversampling_n = 3;
  double footprint_px = 1.4;
  double lateral_sigma_m = 0.0006;  ///< jitter of the ray, on the surface
  double axial_scale = 1.0;         ///< times Fankhauser's σ_z
  /// Light by way of a wall arrives late: floor and parts near it are seen b·(1 − d/L)² too far.
  double multipath_m = 0.012;
  double multipath_reach_m = 0.06;
  double offset_m = 0;  ///< of this device, up to 24 mm either way
  /// Surfaces flatter to the ray than this lose their reading more and more often.
  double grazing_from_rad = 1.4;
  double dropout_at_grazing = 0.5;
  double dropout_share = 0.002;        ///< of any pixel
  double glare_half_angle_rad = 0.12;  ///< a glossy surface seen straight on blinds the pixel
  double edge_filter_m = 0.1;  ///< libfreenect2 zeroes a pixel whose 3 × 3 span more than this
};

/// σ_z in metres at `z_m` for a surface whose normal is `theta_rad` off the ray (Fankhauser 2015,
/// in mm: 1.5 − 0.5 z + 0.3 z² + 0.1 z^1.5 θ² / (π/2 − θ)²), clamped near 80°.
double axial_sigma_m(double z_m, double theta_rad);

/// The bin's inner walls, which bend the floor between them.
struct Walls {
  Eigen::Isometry3d T_camera_bin = Eigen::Isometry3d::Identity();
  Eigen::Vector3d inner_size_m = Eigen::Vector3d::Zero();
};

/// Makes a Kinect v2 frame of what `meshes` show. The same seed makes the same frame.
/// \param gloss by mesh id, 0 … 1: how often a glossy surface loses its reading; absent is 0.
DepthFrame sense(std::span<const PosedMesh> meshes, const std::optional<Walls>& walls,
                 const std::vector<double>& gloss, const KinectV2Parameters& parameters,
                 std::uint64_t seed);

}  // namespace graspd::sim_cell
