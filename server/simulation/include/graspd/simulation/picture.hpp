#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "graspd/simulation/render.hpp"
#include "graspd/types/result.hpp"

namespace graspd::simulation {

using Rgb = std::array<std::uint8_t, 3>;

/// Row by row from the top left.
struct Picture {
  int width_px = 0;
  int height_px = 0;
  std::vector<Rgb> pixels;
};

/// What `render` saw, each object in its colour, lit from above the viewer's left shoulder.
/// \param colors one for each object
Picture shaded(const Rendering& rendering, std::span<const Rgb> colors);

/// A camera at `from_m` that looks at `at_m`, its image upright: T_base_camera.
Eigen::Isometry3d looking_at(const Eigen::Vector3d& at_m, const Eigen::Vector3d& from_m);

/// An animation that repeats for ever, of pictures of one size, in the 256 colours that they have
/// most of. \param delay_s between two pictures
Result<void> write_gif(const std::filesystem::path& path, std::span<const Picture> pictures,
                       double delay_s);

}  // namespace graspd::simulation
