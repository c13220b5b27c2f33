#include "rvl.hpp"

#include <algorithm>
#include <optional>

namespace graspd::codec {
namespace {

constexpr int kWord_bytes = 4;
constexpr int kWord_nibbles = 8;

class NibbleWriter {
 public:
  void write(std::uint32_t value) {
    do {
      std::uint32_t nibble = value & 7;
      value >>= 3;
      if (value != 0) nibble |= 8;
      put(nibble);
    } while (value != 0);
  }

  std::vector<std::byte> finish() {
    while (nibbles_n_ != 0) put(0);
    return std::move(bytes_);
  }

 private:
  void put(std::uint32_t nibble) {
    word_ = word_ << 4 | nibble;
    if (++nibbles_n_ < kWord_nibbles) return;
    for (int i = 0; i < kWord_bytes; ++i) bytes_.push_back(static_cast<std::byte>(word_ >> 8 * i));
    word_ = 0;
    nibbles_n_ = 0;
  }

  std::vector<std::byte> bytes_;
  std::uint32_t word_ = 0;
  int nibbles_n_ = 0;
};

class NibbleReader {
 public:
  explicit NibbleReader(Bytes bytes) : bytes_(bytes) {}

  /// Empty at the end of the payload, and for a number of more than 30 bits, which no image needs.
  std::optional<std::uint32_t> read() {
    constexpr int kMaxShift = 27;
    std::uint32_t value = 0;
    for (int shift = 0; shift <= kMaxShift; shift += 3) {
      if (nibbles_n_ == 0 && !load_word()) return std::nullopt;
      const std::uint32_t nibble = word_ >> 28;
      word_ <<= 4;
      --nibbles_n_;
      value |= (nibble & 7) << shift;
      if ((nibble & 8) == 0) return value;
    }
    return std::nullopt;
  }

  /// Whether nothing follows but the zeros that fill the last word.
  bool finished() const { return position_ == bytes_.size() && word_ == 0; }

 private:
  bool load_word() {
    if (bytes_.size() - position_ < kWord_bytes) return false;
    word_ = 0;
    for (int i = 0; i < kWord_bytes; ++i) {
      word_ |= std::to_integer<std::uint32_t>(bytes_[position_++]) << 8 * i;
    }
    nibbles_n_ = kWord_nibbles;
    return true;
  }

  Bytes bytes_;
  std::size_t position_ = 0;
  std::uint32_t word_ = 0;
  int nibbles_n_ = 0;
};

std::uint32_t zigzag(std::int32_t delta) {
  return static_cast<std::uint32_t>(delta) << 1 ^ static_cast<std::uint32_t>(delta >> 31);
}

std::int32_t unzigzag(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

/// The length of the next run, where it is one that the image still has room for.
std::optional<std::size_t> read_run(NibbleReader& reader, std::size_t room_n) {
  const auto run_n = reader.read();
  if (!run_n || *run_n > room_n) return std::nullopt;
  return *run_n;
}

bool read_readings(NibbleReader& reader, std::size_t run_n, std::int32_t& previous,
                   std::vector<std::uint16_t>& depth) {
  for (std::size_t i = 0; i < run_n; ++i) {
    const auto delta = reader.read();
    if (!delta) return false;
    previous += unzigzag(*delta);
    if (previous < 1 || previous > 0xffff) return false;
    depth.push_back(static_cast<std::uint16_t>(previous));
  }
  return true;
}

}  // namespace

std::vector<std::byte> rvl_encode(std::span<const std::uint16_t> depth) {
  NibbleWriter writer;
  std::int32_t previous = 0;
  for (auto pixel = depth.begin(); pixel != depth.end();) {
    const auto readings = std::find_if(pixel, depth.end(), [](auto z) { return z != 0; });
    const auto zeros = std::find(readings, depth.end(), 0);
    writer.write(static_cast<std::uint32_t>(readings - pixel));
    writer.write(static_cast<std::uint32_t>(zeros - readings));
    for (pixel = readings; pixel != zeros; ++pixel) {
      writer.write(zigzag(*pixel - previous));
      previous = *pixel;
    }
  }
  return writer.finish();
}

Result<std::vector<std::uint16_t>> rvl_decode(Bytes payload, std::size_t pixels_n) {
  const auto broken = [&](std::size_t decoded_n) {
    return invalid("the RVL payload of {} bytes is broken after {} of {} pixels", payload.size(),
                   decoded_n, pixels_n);
  };
  NibbleReader reader(payload);
  std::vector<std::uint16_t> depth;
  depth.reserve(pixels_n);
  std::int32_t previous = 0;
  while (depth.size() < pixels_n) {
    const std::size_t before_n = depth.size();
    const auto zeros_n = read_run(reader, pixels_n - depth.size());
    if (!zeros_n) return broken(depth.size());
    depth.resize(depth.size() + *zeros_n, 0);
    const auto readings_n = read_run(reader, pixels_n - depth.size());
    if (!readings_n || !read_readings(reader, *readings_n, previous, depth)) {
      return broken(depth.size());
    }
    if (depth.size() == before_n) return broken(depth.size());
  }
  if (!reader.finished()) {
    return invalid("the RVL payload of {} bytes goes on after the last of {} pixels",
                   payload.size(), pixels_n);
  }
  return depth;
}

}  // namespace graspd::codec
