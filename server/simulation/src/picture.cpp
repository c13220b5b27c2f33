#include "graspd/simulation/picture.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::simulation {
namespace {

constexpr Rgb kBackground{245, 245, 245};
/// In the optical frame, towards the light.
const Eigen::Vector3f kLight = Eigen::Vector3f(-0.4F, -0.8F, -0.6F).normalized();
constexpr float kAmbient = 0.45F;

}  // namespace

Picture shaded(const Rendering& rendering, std::span<const Rgb> colors) {
  Picture picture{rendering.camera.width_px, rendering.camera.height_px, {}};
  picture.pixels.reserve(rendering.object.size());
  for (std::size_t i = 0; i < rendering.object.size(); ++i) {
    if (rendering.object[i] == Rendering::kNothing) {
      picture.pixels.push_back(kBackground);
      continue;
    }
    const Eigen::Vector3f& normal =
        rendering.facet_normals[static_cast<std::size_t>(rendering.facet[i])];
    const float light = kAmbient + (1 - kAmbient) * std::max(0.0F, normal.dot(kLight));
    Rgb pixel = colors[static_cast<std::size_t>(rendering.object[i])];
    for (std::uint8_t& channel : pixel) {
      channel = static_cast<std::uint8_t>(std::lround(static_cast<float>(channel) * light));
    }
    picture.pixels.push_back(pixel);
  }
  return picture;
}

Eigen::Isometry3d looking_at(const Eigen::Vector3d& at_m, const Eigen::Vector3d& from_m) {
  Eigen::Matrix3d axes;
  axes.col(2) = (at_m - from_m).normalized();
  axes.col(0) = axes.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Eigen::Translation3d(from_m) * Eigen::Quaterniond(axes);
}

}  // namespace graspd::simulation
