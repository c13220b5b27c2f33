#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "graspd/types/result.hpp"

namespace graspd {

/// 16-bit single-channel image: depth, or instance ids.
struct Image16 {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> values;  ///< row by row
};

/// \returns INVALID_ARGUMENT where the file is not there, damaged, or not 16-bit with one channel
/// (8-bit images with one channel are widened).
Result<Image16> read_png16(const std::filesystem::path& path);
/// \returns INVALID_ARGUMENT where the file can't be written.
Result<void> write_png16(const std::filesystem::path& path, const Image16& image);

}  // namespace graspd
