#include <bit>
#include <cstring>

#include "convert.hpp"
#include "crc32.hpp"
#include "graspd/codec/codec.hpp"
#include "rvl.hpp"

namespace graspd::codec {
namespace {

static_assert(std::endian::native == std::endian::little, "raw depth is sent as it lies in memory");

std::size_t pixels_n(const CameraIntrinsics& camera) {
  return static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
}

Result<std::vector<std::uint16_t>> decode_depth(const FrameDescription& description,
                                                Bytes payload) {
  const std::size_t depth_n = pixels_n(description.camera);
  if (description.encoding == DepthEncoding::kRvl) return rvl_decode(payload, depth_n);
  std::vector<std::uint16_t> depth(depth_n);
  std::memcpy(depth.data(), payload.data(), payload.size());
  return depth;
}

Error within(std::string_view field, const Error& error) {
  return {error.code, fmt::format("{}.{}", field, error.message)};
}

}  // namespace

Result<void> validate(const FrameDescription& frame) {
  if (auto ok = validate(frame.camera); !ok) return ok;
  if (!(frame.depth_scale_m > 0)) {
    return invalid("depth_scale_m: {} m per unit; 0.001 says that units are millimetres",
                   frame.depth_scale_m);
  }
  if (frame.payload_bytes == 0 || frame.payload_bytes > kMaxPayload_bytes) {
    return invalid("payload_bytes: {}; 1 … {} are taken", frame.payload_bytes, kMaxPayload_bytes);
  }
  const std::size_t raw_bytes = sizeof(std::uint16_t) * pixels_n(frame.camera);
  if (frame.encoding == DepthEncoding::kRaw && frame.payload_bytes != raw_bytes) {
    return invalid("payload_bytes: {}; {} × {} pixels of 2 bytes are {}", frame.payload_bytes,
                   frame.camera.width_px, frame.camera.height_px, raw_bytes);
  }
  return {};
}

EncodedFrame encode_frame(const DepthFrame& frame, DepthEncoding encoding) {
  const auto raw = std::as_bytes(std::span(frame.depth));
  EncodedFrame encoded;
  if (encoding == DepthEncoding::kRvl) encoded.payload = rvl_encode(frame.depth);
  if (encoding == DepthEncoding::kRaw || encoded.payload.size() >= raw.size()) {
    encoding = DepthEncoding::kRaw;
    encoded.payload.assign(raw.begin(), raw.end());
  }
  encoded.description = {.camera = frame.camera,
                         .depth_scale_m = frame.depth_scale_m,
                         .encoding = encoding,
                         .payload_bytes = static_cast<std::uint32_t>(encoded.payload.size()),
                         .payload_crc32 = crc32_of(encoded.payload)};
  return encoded;
}

Result<DepthFrame> decode_frame(const FrameDescription& description, Bytes payload) {
  if (auto ok = validate(description); !ok) {
    return tl::unexpected(within("plan.frame", ok.error()));
  }
  if (payload.size() != description.payload_bytes) {
    return invalid("plan.frame.payload_bytes: {}, but the payload has {} bytes",
                   description.payload_bytes, payload.size());
  }
  if (const std::uint32_t crc32 = crc32_of(payload); crc32 != description.payload_crc32) {
    return invalid(
        "plan.frame.payload_crc32: {:#010x}, but the payload of {} bytes has {:#010x}; it was "
        "damaged on its way, or is another frame's",
        description.payload_crc32, payload.size(), crc32);
  }
  auto depth = decode_depth(description, payload);
  if (!depth) return invalid("plan.frame: {}", depth.error().message);
  DepthFrame frame{description.camera, description.depth_scale_m, std::move(*depth)};
  if (auto ok = validate(frame); !ok) return tl::unexpected(within("plan", ok.error()));
  return frame;
}

}  // namespace graspd::codec
