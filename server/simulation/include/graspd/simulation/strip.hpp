#pragma once

#include "graspd/simulation/picture.hpp"

namespace graspd::simulation {

/// Some of an animation's pictures side by side, for pages and prints that don't move: evenly
/// spread, the first and the last among them.
/// \param pictures of one size; of fewer than `count_n` all
Picture strip(std::span<const Picture> pictures, std::size_t count_n);

/// \returns INVALID_ARGUMENT where the file can't be written.
Result<void> write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace graspd::simulation
