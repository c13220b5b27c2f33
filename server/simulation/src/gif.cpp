// GIF89a: a palette for all pictures, then each picture as indices into it, packed by LZW.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <unordered_map>

#include "graspd/simulation/picture.hpp"

namespace graspd::simulation {
namespace {

constexpr int kPaletteBits = 8;
constexpr int kClear = 1 << kPaletteBits;
constexpr int kEnd = kClear + 1;
constexpr int kMaxCodes = 4096;
constexpr std::size_t kBlock = 255;

constexpr std::size_t kColors = 1 << kPaletteBits;

/// The colours that the pictures have most of; all others become the nearest of these.
class Palette {
 public:
  explicit Palette(std::span<const Picture> pictures) : index_(std::size_t(1) << 15) {
    std::vector<Sum> sums(index_.size());
    for (const Picture& picture : pictures) {
      for (const Rgb& pixel : picture.pixels) sums[coarse(pixel)].add(pixel);
    }
    std::vector<Sum> ranked = sums;
    std::ranges::stable_sort(ranked, std::ranges::greater(), &Sum::pixels_n);
    for (std::size_t i = 0; i < kColors; ++i) colors_.push_back(ranked[i].mean());
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (sums[i].pixels_n > 0) index_[i] = nearest(sums[i].mean());
    }
  }

  std::uint8_t index_of(const Rgb& pixel) const { return index_[coarse(pixel)]; }
  const std::vector<Rgb>& colors() const { return colors_; }

 private:
  struct Sum {
    std::array<std::uint64_t, 3> channels{};
    std::uint64_t pixels_n = 0;

    void add(const Rgb& pixel) {
      for (std::size_t c = 0; c < 3; ++c) channels[c] += pixel[c];
      ++pixels_n;
    }
    Rgb mean() const {
      Rgb mean{};
      if (pixels_n == 0) return mean;
      for (std::size_t c = 0; c < 3; ++c) mean[c] = std::uint8_t(channels[c] / pixels_n);
      return mean;
    }
  };

  static std::size_t coarse(const Rgb& pixel) {
    return std::size_t(pixel[0] >> 3) << 10 | std::size_t(pixel[1] >> 3) << 5 | pixel[2] >> 3;
  }
  std::uint8_t nearest(const Rgb& color) const {
    const auto distance = [&color](const Rgb& other) {
      int sum = 0;
      for (std::size_t c = 0; c < 3; ++c) sum += (color[c] - other[c]) * (color[c] - other[c]);
      return sum;
    };
    return std::uint8_t(std::ranges::min_element(colors_, {}, distance) - colors_.begin());
  }

  std::vector<Rgb> colors_;
  std::vector<std::uint8_t> index_;
};

void put(std::string& out, int byte) { out.push_back(static_cast<char>(byte)); }
void put16(std::string& out, int value) {
  put(out, value & 255);
  put(out, value >> 8);
}

/// Codes of growing width, the lowest bit first.
class BitWriter {
 public:
  void write(int code, int bits) {
    held_ |= static_cast<std::uint32_t>(code) << held_n_;
    for (held_n_ += bits; held_n_ >= 8; held_n_ -= 8, held_ >>= 8) put(bytes_, held_ & 255);
  }
  std::string finish() {
    if (held_n_ > 0) put(bytes_, held_ & 255);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
  std::uint32_t held_ = 0;
  int held_n_ = 0;
};

std::string lzw(const Picture& picture, const Palette& palette) {
  BitWriter bits;
  std::unordered_map<std::uint32_t, int> codes;  ///< of a known string and the byte after it
  int width = kPaletteBits + 1, next = kEnd + 1;
  bits.write(kClear, width);
  int known = palette.index_of(picture.pixels.front());
  for (std::size_t i = 1; i < picture.pixels.size(); ++i) {
    const int byte = palette.index_of(picture.pixels[i]);
    const auto longer = static_cast<std::uint32_t>(known << kPaletteBits | byte);
    if (const auto found = codes.find(longer); found != codes.end()) {
      known = found->second;
      continue;
    }
    bits.write(known, width);
    known = byte;
    if (next == kMaxCodes) {
      bits.write(kClear, width);
      codes.clear();
      width = kPaletteBits + 1;
      next = kEnd + 1;
      continue;
    }
    if (next == 1 << width) ++width;
    codes[longer] = next++;
  }
  bits.write(known, width);
  if (next == 1 << width && next < kMaxCodes) ++width;
  bits.write(kEnd, width);
  return bits.finish();
}

std::string image_of(const Picture& picture, const Palette& palette, double delay_s) {
  std::string out("\x21\xF9\x04\x00", 4);  // graphic control
  put16(out, static_cast<int>(std::lround(100 * delay_s)));
  out += std::string("\x00\x00\x2C\x00\x00\x00\x00", 7);  // image at (0, 0)
  put16(out, picture.width_px);
  put16(out, picture.height_px);
  put(out, 0);
  put(out, kPaletteBits);
  const std::string data = lzw(picture, palette);
  for (std::size_t i = 0; i < data.size(); i += kBlock) {
    const std::string block = data.substr(i, kBlock);
    put(out, static_cast<int>(block.size()));
    out += block;
  }
  put(out, 0);
  return out;
}

}  // namespace

Result<void> write_gif(const std::filesystem::path& path, std::span<const Picture> pictures,
                       double delay_s) {
  if (pictures.empty()) return invalid("{}: no pictures to write", path.string());
  std::string out = "GIF89a";
  put16(out, pictures.front().width_px);
  put16(out, pictures.front().height_px);
  out += std::string("\xF7\x00\x00", 3);
  const Palette palette(pictures);
  for (const Rgb& color : palette.colors()) out.append(color.begin(), color.end());
  out += std::string("\x21\xFF\x0BNETSCAPE2.0\x03\x01\x00\x00\x00", 19);  // for ever
  for (const Picture& picture : pictures) {
    if (picture.width_px != pictures.front().width_px ||
        picture.height_px != pictures.front().height_px) {
      return invalid("{}: pictures of different sizes", path.string());
    }
    out += image_of(picture, palette, delay_s);
  }
  out += "\x3B";
  std::ofstream file(path, std::ios::binary);
  file << out << std::flush;
  if (!file) return invalid("{}: can't be written; is its folder there?", path.string());
  return {};
}

}  // namespace graspd::simulation
