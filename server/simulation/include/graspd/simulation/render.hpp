#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "graspd/types/frame.hpp"

namespace graspd::simulation {

/// A mesh in front of the camera. The mesh must outlive its uses.
struct SceneObject {
  const parts::Mesh* mesh = nullptr;
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
  double gloss = 0;  ///< 0 matt … 1 polished: how often the sensor gets no reading from it
};

/// What a perfect camera sees through the centre of each pixel, row by row.
struct Rendering {
  static constexpr std::int32_t kNothing = -1;

  CameraIntrinsics camera;
  std::vector<float> z_m;                      ///< in the optical frame; 0 where nothing is
  std::vector<std::int32_t> object;            ///< index into the objects, or kNothing
  std::vector<std::int32_t> facet;             ///< index into `facet_normals`, or kNothing
  std::vector<Eigen::Vector3f> facet_normals;  ///< unit, in the optical frame, towards the camera

  std::size_t index(int u, int v) const {
    return std::size_t(v) * std::size_t(camera.width_px) + std::size_t(u);
  }
};

/// Draws triangles into a z-buffer, both sides of each, cut off 10 mm before the camera. Where the
/// camera has distortion coefficients, each pixel looks along its own, distorted ray, to a sixth of
/// a pixel.
Rendering render(const CameraIntrinsics& camera, std::span<const SceneObject> objects);

/// Of each object: its pixels that are seen / its pixels if it were alone in the image. 0 where it
/// has none. Everything in the scene hides, walls included.
std::vector<double> visible_fractions(const Rendering& rendering,
                                      std::span<const SceneObject> objects);

}  // namespace graspd::simulation
