#pragma once

#include <libdeflate.h>

#include <cstdint>
#include <span>

namespace graspd::codec {

/// Not zlib's: the same number took it three times as long, half of a worker's decoding.
/// \param before that of the bytes in front of these
inline std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before = 0) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

}  // namespace graspd::codec
