#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graspd/codec/codec.hpp"

/// Wilson, "Fast Lossless Depth Image Compression" (2017), byte for byte as in the paper's code: an
/// image is runs of zeros and of readings, in turn; a run of readings is the zig-zag of each one's
/// difference to the last. Every number is a row of nibbles, three bits each, least significant
/// first, and a fourth bit for "more follows". Eight nibbles fill a little-endian 32-bit word from
/// its top.
namespace graspd::codec {

std::vector<std::byte> rvl_encode(std::span<const std::uint16_t> depth);

/// Reads nothing outside `payload`, and never holds more than `pixels_n` pixels whatever it says.
/// \returns INVALID_ARGUMENT for what is not RVL of exactly `pixels_n` pixels.
Result<std::vector<std::uint16_t>> rvl_decode(Bytes payload, std::size_t pixels_n);

}  // namespace graspd::codec
