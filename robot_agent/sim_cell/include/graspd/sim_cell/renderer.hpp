#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::sim_cell {

/// A mesh where it stands. Several may share an id; 0 is the background.
struct PosedMesh {
  const parts::Mesh* mesh = nullptr;
  Eigen::Isometry3d T_camera_mesh = Eigen::Isometry3d::Identity();
  std::uint16_t id = 0;
};

/// What an ideal camera sees, row by row.
struct Rendering {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> depth_m;           ///< z in the optical frame; 0 where there is nothing
  std::vector<std::uint16_t> id;        ///< of the nearest mesh; 0 where there is nothing
  std::vector<Eigen::Vector3f> normal;  ///< unit, towards the camera; zero where nothing is

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
           static_cast<std::size_t>(u);
  }
};

/// Z-buffer rasteriser for pinhole cameras. Distortion is not applied: simulated frames are
/// rectified, as drivers give them. Both sides of a triangle are drawn; what reaches nearer than
/// `kNearPlane_m` is left out.
Rendering render(const CameraIntrinsics& camera, std::span<const PosedMesh> meshes);

inline constexpr double kNearPlane_m = 0.05;

/// The same view with `factor` × `factor` samples for each pixel.
CameraIntrinsics oversampled(const CameraIntrinsics& camera, int factor);

/// Visible pixels over pixels without any other mesh, for each of the meshes.
std::vector<double> visible_fractions(const CameraIntrinsics& camera,
                                      std::span<const PosedMesh> meshes,
                                      const Rendering& rendering);

}  // namespace graspd::sim_cell
