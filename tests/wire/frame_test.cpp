#include <gtest/gtest.h>
#include <zlib.h>

#include <limits>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "same_message.hpp"
#include "schema.hpp"

namespace graspd::testing {
namespace {

using codec::Bytes;
using codec::EncodedFrame;

std::uint32_t crc32_of(Bytes bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

DepthFrame frame_of(int width_px, int height_px, std::vector<std::uint16_t> depth) {
  return {.camera = {.width_px = width_px,
                     .height_px = height_px,
                     .fx_px = 365.5,
                     .fy_px = 365.5,
                     .cx_px = width_px / 2.0,
                     .cy_px = height_px / 2.0},
          .depth_scale_m = 0.001,
          .depth = std::move(depth)};
}

/// Images that are hard in different ways, each with at least one reading.
std::vector<DepthFrame> some_frames() {
  constexpr int kSide_px = 64;
  constexpr std::size_t kPixels_n = kSide_px * kSide_px;
  std::mt19937 rng(1);
  std::vector<std::uint16_t> lonely(kPixels_n, 0), flat(kPixels_n, 1000), extremes(kPixels_n),
      noisy(kPixels_n), anything(kPixels_n), sparse(kPixels_n, 0);
  lonely[kPixels_n / 3] = 65535;
  for (std::size_t i = 0; i < kPixels_n; ++i) {
    extremes[i] = i % 2 == 0 ? 1 : 65535;
    noisy[i] = static_cast<std::uint16_t>(rng() % 20 == 0 ? 0 : 1000 + i / 64 + rng() % 5);
    anything[i] = static_cast<std::uint16_t>(rng());
    if (i % 7 == 0) sparse[i] = static_cast<std::uint16_t>(1 + rng() % 65535);
  }
  std::vector<DepthFrame> frames;
  for (auto* depth : {&lonely, &flat, &extremes, &noisy, &anything, &sparse}) {
    frames.push_back(frame_of(kSide_px, kSide_px, *depth));
  }
  RandomMessages random(1);
  for (int i = 0; i < 20; ++i) frames.push_back(random.any_depth_frame());
  return frames;
}

void expect_refused(const FrameDescription& description, Bytes payload, const std::string& words) {
  const auto decoded = codec::decode_frame(description, payload);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, Code::kInvalidArgument);
  EXPECT_NE(decoded.error().message.find(words), std::string::npos) << decoded.error().message;
}

TEST(Frame, ComesBackInEveryEncoding) {
  for (const auto& [encoding, name] : EnumNames<DepthEncoding>::values) {
    for (const DepthFrame& frame : some_frames()) {
      const EncodedFrame encoded = codec::encode_frame(frame, encoding);
      EXPECT_EQ(encoded.description.payload_bytes, encoded.payload.size());
      EXPECT_EQ(encoded.description.payload_crc32, crc32_of(encoded.payload));
      const auto decoded = codec::decode_frame(encoded.description, encoded.payload);
      ASSERT_TRUE(decoded) << name << ": " << decoded.error().message;
      EXPECT_TRUE(same(*decoded, frame)) << name;
    }
  }
}

TEST(Frame, RawIsLittleEndianRowByRow) {
  std::vector<std::uint16_t> depth(64, 0x0201);
  depth[1] = 0x0403;
  const EncodedFrame encoded = codec::encode_frame(frame_of(8, 8, depth), DepthEncoding::kRaw);
  ASSERT_EQ(encoded.payload.size(), 128u);
  const std::vector<std::byte> start(encoded.payload.begin(), encoded.payload.begin() + 4);
  EXPECT_EQ(start,
            (std::vector<std::byte>{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}}));
}

TEST(Frame, PayloadOfAnotherSizeIsRefused) {
  EncodedFrame encoded = codec::encode_frame(some_frames()[1], DepthEncoding::kRaw);
  const Bytes payload(encoded.payload);
  expect_refused(encoded.description, payload.first(payload.size() - 1),
                 "plan.frame.payload_bytes: 8192, but the payload has 8191 bytes");
  expect_refused(encoded.description, {}, "plan.frame.payload_bytes: 8192, but the payload has 0");
  encoded.description.payload_bytes -= 2;
  expect_refused(encoded.description, payload.first(payload.size() - 2),
                 "plan.frame.payload_bytes: 8190; 64 × 64 pixels of 2 bytes are 8192");
}

TEST(Frame, EveryDamagedByteIsNoticed) {
  for (const auto& [encoding, name] : EnumNames<DepthEncoding>::values) {
    EncodedFrame encoded = codec::encode_frame(some_frames()[3], encoding);
    ASSERT_EQ(encoded.description.encoding, encoding);
    for (std::byte& byte : encoded.payload) {
      byte ^= std::byte{0x10};
      expect_refused(encoded.description, encoded.payload, "plan.frame.payload_crc32: 0x");
      byte ^= std::byte{0x10};
    }
  }
}

TEST(Frame, WithoutAReadingIsRefused) {
  const EncodedFrame encoded =
      codec::encode_frame(frame_of(8, 8, std::vector<std::uint16_t>(64, 0)), DepthEncoding::kRaw);
  expect_refused(encoded.description, encoded.payload,
                 "plan.frame: all 64 pixels are 0, which means no reading");
}

TEST(Frame, EveryFieldOfTheDescriptionIsChecked) {
  const EncodedFrame encoded = codec::encode_frame(some_frames()[3], DepthEncoding::kRaw);
  const auto refused = [&](auto change, const std::string& words) {
    FrameDescription description = encoded.description;
    change(description);
    expect_refused(description, encoded.payload, words);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refused([](auto& d) { d.camera.fx_px = kNan; }, "plan.frame.camera.fx_px: nan");
  refused([](auto& d) { d.camera.fy_px = 0; }, "plan.frame.camera.fy_px: 0");
  refused([](auto& d) { d.camera.width_px = 0; }, "plan.frame.camera: an image of 0 × 64 pixels");
  refused([](auto& d) { d.camera.width_px = 32; }, "32 × 64 pixels of 2 bytes are 4096");
  refused([](auto& d) { d.depth_scale_m = kNan; }, "plan.frame.depth_scale_m: nan");
  refused([](auto& d) { d.depth_scale_m = 1; }, "plan.frame.depth_scale_m: 1 m per unit");
  refused([](auto& d) { d.payload_bytes = 0; }, "plan.frame.payload_bytes: 0");
  refused([](auto& d) { d.payload_crc32 ^= 1; }, "plan.frame.payload_crc32");
}

TEST(Rvl, IsTheOneOfThePaper) {
  // Worked by hand: 0 zeros, 3 readings of 10, 12 and 11, then 61 zeros and 0 readings. Nibbles:
  // 0 | 3 | zigzag(10) = 20 = 24₈ → c 2 | zigzag(2) = 4 | zigzag(−1) = 1 | 61 = 75₈ → d 7 | 0.
  std::vector<std::uint16_t> depth(64, 0);
  depth[0] = 10, depth[1] = 12, depth[2] = 11;
  const EncodedFrame encoded = codec::encode_frame(frame_of(8, 8, depth), DepthEncoding::kRvl);
  ASSERT_EQ(encoded.description.encoding, DepthEncoding::kRvl);
  std::vector<int> bytes;
  for (const std::byte byte : encoded.payload) bytes.push_back(std::to_integer<int>(byte));
  // Words 0x03c241d7 and 0x00000000, little-endian.
  EXPECT_EQ(bytes, (std::vector<int>{0xd7, 0x41, 0xc2, 0x03, 0, 0, 0, 0}));
}

TEST(Rvl, FallsBackToRawWhereItWouldGrow) {
  const auto frames = some_frames();
  const auto& extremes = frames[2];
  const EncodedFrame encoded = codec::encode_frame(extremes, DepthEncoding::kRvl);
  EXPECT_EQ(encoded.description.encoding, DepthEncoding::kRaw);
  EXPECT_EQ(encoded.payload.size(), 2 * extremes.depth.size());
}

/// Decodes with a checksum that fits, as a hostile sender's would. What comes out is an image of
/// the described size or an error; the sanitisers watch the bounds.
bool decodes(FrameDescription description, Bytes payload) {
  description.payload_bytes = static_cast<std::uint32_t>(payload.size());
  description.payload_crc32 = crc32_of(payload);
  const std::vector<std::byte> exact(payload.begin(), payload.end());
  const auto decoded = codec::decode_frame(description, exact);
  if (decoded) {
    EXPECT_EQ(decoded->depth.size(),
              static_cast<std::size_t>(description.camera.width_px * description.camera.height_px));
  }
  return decoded.has_value();
}

/// Nibbles in reading order, eight to a word, as the bytes that are sent.
std::vector<std::byte> words(const std::string& nibbles) {
  std::vector<std::byte> bytes;
  for (std::size_t word = 0; word < nibbles.size(); word += 8) {
    for (int byte = 3; byte >= 0; --byte) {
      const auto digits = nibbles.substr(word + 2 * static_cast<std::size_t>(byte), 2);
      bytes.push_back(static_cast<std::byte>(std::stoi(digits, nullptr, 16)));
    }
  }
  return bytes;
}

TEST(Rvl, EveryCheckOfThePayload) {
  FrameDescription description =
      codec::encode_frame(frame_of(8, 8, std::vector<std::uint16_t>(64, 9)), DepthEncoding::kRvl)
          .description;
  const auto accepts = [&](const std::string& nibbles) {
    const auto payload = words(nibbles);
    description.payload_bytes = static_cast<std::uint32_t>(payload.size());
    description.payload_crc32 = crc32_of(payload);
    const auto decoded = codec::decode_frame(description, payload);
    if (!decoded) {
      EXPECT_NE(decoded.error().message.find("plan.frame: the RVL payload"), std::string::npos)
          << decoded.error().message;
    }
    return decoded.has_value();
  };
  // No zeros, one reading that is 1 above 0, 63 zeros, no readings, and the rest of the word.
  EXPECT_TRUE(accepts("012f7000"));
  EXPECT_TRUE(accepts("01effff3f7000000")) << "a reading of 65535";

  EXPECT_FALSE(accepts("0221e700")) << "readings of 1 and 0";
  EXPECT_FALSE(accepts("011f7000")) << "a reading of -1";
  EXPECT_FALSE(accepts("022888884e700000")) << "readings of 1 and 65537";
  EXPECT_FALSE(accepts("012f7001")) << "something in the rest of the word";
  EXPECT_FALSE(accepts("012f700000000000")) << "a word too many";
  EXPECT_FALSE(accepts("01288100")) << "64 zeros where 63 have room";
  EXPECT_FALSE(accepts("09812222")) << "65 readings";
  EXPECT_FALSE(accepts("01200f70")) << "a run of nothing";
  EXPECT_FALSE(accepts("012fffff")) << "a number that goes on at the end";
  EXPECT_FALSE(accepts("01a8888888880f70")) << "a number of 33 bits";
}

TEST(Rvl, TruncatedPayloadsAreRefused) {
  const EncodedFrame encoded = codec::encode_frame(some_frames()[3], DepthEncoding::kRvl);
  ASSERT_TRUE(decodes(encoded.description, encoded.payload));
  const Bytes payload(encoded.payload);
  for (std::size_t size = 0; size < payload.size(); ++size) {
    ASSERT_FALSE(decodes(encoded.description, payload.first(size))) << size;
  }
}

TEST(Rvl, ProlongedPayloadsAreRefused) {
  EncodedFrame encoded = codec::encode_frame(some_frames()[3], DepthEncoding::kRvl);
  for (int i = 0; i < 16; ++i) {
    encoded.payload.push_back(std::byte{0});
    EXPECT_FALSE(decodes(encoded.description, encoded.payload));
  }
}

TEST(Rvl, CorruptedPayloadsStayInBounds) {
  const EncodedFrame encoded = codec::encode_frame(some_frames()[3], DepthEncoding::kRvl);
  std::mt19937 rng(4);
  int refused_n = 0;
  for (int i = 0; i < 5000; ++i) {
    auto payload = encoded.payload;
    for (auto changes_n = 1 + rng() % 4; changes_n > 0; --changes_n) {
      payload[rng() % payload.size()] = static_cast<std::byte>(rng());
    }
    if (!decodes(encoded.description, payload)) ++refused_n;
  }
  EXPECT_GT(refused_n, 1000);
}

TEST(Rvl, RandomPayloadsStayInBounds) {
  const FrameDescription description =
      codec::encode_frame(some_frames()[3], DepthEncoding::kRvl).description;
  std::mt19937 rng(5);
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::byte> payload(1 + rng() % 64);
    for (std::byte& byte : payload) byte = static_cast<std::byte>(rng());
    decodes(description, payload);
  }
}

TEST(Rvl, BombsAreRefused) {
  FrameDescription description =
      codec::encode_frame(some_frames()[3], DepthEncoding::kRvl).description;
  description.camera.width_px = description.camera.height_px = kMaxImageSide_px;
  const auto payload_of = [](std::size_t size, int byte) {
    return std::vector<std::byte>(size, std::byte(byte));
  };
  // Runs of nothing, which would never end; numbers without end; runs longer than any image.
  EXPECT_FALSE(decodes(description, payload_of(kMaxPayload_bytes, 0)));
  EXPECT_FALSE(decodes(description, payload_of(kMaxPayload_bytes, 0xff)));
  const std::byte endless_run[] = {std::byte{0xff}, std::byte{0xff}, std::byte{0xff},
                                   std::byte{0xff}, std::byte{0x00}, std::byte{0x00},
                                   std::byte{0x70}, std::byte{0xff}};
  EXPECT_FALSE(decodes(description, endless_run));
}

}  // namespace
}  // namespace graspd::testing
