#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "graspd/simulation/strip.hpp"
#include "temporary_folder.hpp"

namespace graspd::simulation {
namespace {

using ::testing::HasSubstr;

/// Reads what `write_gif` writes, by the format's definition.
class GifReader {
 public:
  explicit GifReader(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  std::vector<Picture> pictures() {
    constexpr std::size_t kHeader = 13;
    const int width_px = word(6), height_px = word(8);
    at_ = kHeader;
    for (Rgb& color : palette_) color = {byte(), byte(), byte()};
    std::vector<Picture> pictures;
    while (true) {
      const int kind = byte();
      if (kind == 0x3B) return pictures;
      if (kind == 0x21) {
        ++at_;
        blocks();
        continue;
      }
      at_ += 9;  // place, size and flags of the image
      const int bits = byte();
      pictures.push_back({width_px, height_px, unpacked(blocks(), bits)});
    }
  }

 private:
  std::uint8_t byte() { return static_cast<std::uint8_t>(bytes_.at(at_++)); }
  int word(std::size_t at) const {
    return static_cast<std::uint8_t>(bytes_.at(at)) | static_cast<std::uint8_t>(bytes_.at(at + 1))
                                                          << 8;
  }
  std::string blocks() {
    std::string data;
    while (const std::size_t n = byte()) {
      data += bytes_.substr(at_, n);
      at_ += n;
    }
    return data;
  }

  std::vector<Rgb> unpacked(const std::string& data, int bits) const {
    const int clear = 1 << bits;
    std::vector<std::vector<std::uint8_t>> strings;
    std::vector<Rgb> pixels;
    std::vector<std::uint8_t> last;
    int width = bits + 1;
    for (std::size_t bit = 0;;) {
      int code = 0;
      for (int i = 0; i < width; ++i, ++bit) {
        code |= (static_cast<std::uint8_t>(data.at(bit / 8)) >> bit % 8 & 1) << i;
      }
      if (code == clear + 1) return pixels;
      if (code == clear) {
        strings.assign(static_cast<std::size_t>(clear) + 2, {});
        for (int i = 0; i < clear; ++i) {
          strings[static_cast<std::size_t>(i)] = {static_cast<std::uint8_t>(i)};
        }
        width = bits + 1;
        last.clear();
        continue;
      }
      const auto known = static_cast<std::size_t>(code);
      std::vector<std::uint8_t> now = known < strings.size() ? strings[known] : last;
      if (known >= strings.size()) now.push_back(last.at(0));
      for (const std::uint8_t index : now) pixels.push_back(palette_[index]);
      if (!last.empty() && strings.size() < 4096) {
        last.push_back(now.at(0));
        strings.push_back(last);
      }
      if (strings.size() == std::size_t(1) << width && width < 12) ++width;
      last = now;
    }
  }

  std::string bytes_;
  std::size_t at_ = 0;
  std::array<Rgb, 256> palette_{};
};

/// 200 colours in no order, so that the codes run out several times.
Picture noise(std::uint32_t seed) {
  Picture picture{320, 200, {}};
  for (int i = 0; i < picture.width_px * picture.height_px; ++i) {
    seed = seed * 1664525 + 1013904223;
    const auto color = static_cast<int>(seed >> 16) % 200;
    picture.pixels.push_back(
        {static_cast<std::uint8_t>(color % 8 * 32), static_cast<std::uint8_t>(color / 8 * 8), 128});
  }
  return picture;
}

TEST(GifTest, PicturesOfFewColoursComeBackAsTheyWere) {
  const testing::TemporaryFolder folder;
  const Picture plain{320, 200, std::vector<Rgb>(320 * 200, Rgb{8, 16, 128})};
  const std::vector<Picture> pictures{noise(1), plain, noise(2)};
  ASSERT_TRUE(write_gif(folder.path() / "a.gif", pictures, 0.1));
  const std::vector<Picture> read = GifReader(folder.path() / "a.gif").pictures();
  ASSERT_EQ(read.size(), pictures.size());
  for (std::size_t i = 0; i < read.size(); ++i) EXPECT_EQ(read[i].pixels, pictures[i].pixels) << i;
}

TEST(GifTest, WhatCannotBeWrittenIsNamed) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(write_gif(folder.path() / "a.gif", {}, 0.1).error().message,
              HasSubstr("no pictures"));
  const Picture one{1, 1, {Rgb{}}}, two{2, 1, {Rgb{}, Rgb{}}};
  EXPECT_THAT(write_gif(folder.path() / "a.gif", std::vector{one, two}, 0.1).error().message,
              HasSubstr("different sizes"));
  EXPECT_THAT(write_gif(folder.path() / "no" / "a.gif", std::vector{one}, 0.1).error().message,
              HasSubstr("can't be written"));
}

TEST(StripTest, HasTheFirstAndTheLastPictureAndThoseBetweenEvenlySpread) {
  std::vector<Picture> pictures;
  for (std::uint8_t i = 0; i < 7; ++i) pictures.push_back({2, 1, {Rgb{i, 0, 0}, Rgb{0, i, 0}}});
  const Picture row = strip(pictures, 4);
  ASSERT_EQ(row.width_px, 4 * 2 + 3 * 8);
  ASSERT_EQ(row.pixels.size(), 32u);
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_EQ(row.pixels[i * 10u], (Rgb{static_cast<std::uint8_t>(2 * i), 0, 0}));
    EXPECT_EQ(row.pixels[i * 10u + 1], (Rgb{0, static_cast<std::uint8_t>(2 * i), 0}));
  }
  EXPECT_EQ(row.pixels[2], (Rgb{255, 255, 255})) << "the gap";
  EXPECT_EQ(strip(std::span(pictures).first(1), 4).width_px, 2);

  const testing::TemporaryFolder folder;
  EXPECT_TRUE(write_png(folder.path() / "row.png", row));
  EXPECT_THAT(write_png(folder.path() / "no" / "row.png", row).error().message,
              HasSubstr("can't be written"));
}

TEST(PictureTest, TheViewerLooksWhereItIsToldWithItsHeadUp) {
  const Eigen::Vector3d at_m(0.3, 0, 0.1), from_m(1, -1, 0.8);
  const Eigen::Isometry3d T_camera_base = looking_at(at_m, from_m).inverse();
  const Eigen::Vector3d p_m = T_camera_base * at_m;
  EXPECT_NEAR(p_m.head<2>().norm(), 0, 1e-9);
  EXPECT_NEAR(p_m.z(), (at_m - from_m).norm(), 1e-9);
  EXPECT_LT((T_camera_base.linear() * Eigen::Vector3d::UnitZ()).y(), 0) << "up is against y";
  EXPECT_NEAR((T_camera_base.linear() * Eigen::Vector3d::UnitZ()).x(), 0, 1e-9);
}

}  // namespace
}  // namespace graspd::simulation
