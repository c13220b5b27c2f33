#include "graspd/simulation/strip.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

namespace graspd::simulation {
namespace {

constexpr int kGap_px = 8;
constexpr Rgb kGapColor{255, 255, 255};

}  // namespace

Picture strip(std::span<const Picture> pictures, std::size_t count_n) {
  const std::size_t shown_n = std::min(count_n, pictures.size());
  if (shown_n == 0) return {};
  const int width_px = pictures.front().width_px, height_px = pictures.front().height_px;
  const int step_px = width_px + kGap_px;
  Picture row{static_cast<int>(shown_n) * step_px - kGap_px, height_px, {}};
  row.pixels.assign(static_cast<std::size_t>(row.width_px) * static_cast<std::size_t>(height_px),
                    kGapColor);
  for (std::size_t i = 0; i < shown_n; ++i) {
    const Picture& picture = pictures[shown_n == 1 ? 0 : i * (pictures.size() - 1) / (shown_n - 1)];
    for (int y = 0; y < height_px; ++y) {
      std::copy_n(picture.pixels.begin() + std::ptrdiff_t(y) * width_px, width_px,
                  row.pixels.begin() + std::ptrdiff_t(y) * row.width_px +
                      static_cast<std::ptrdiff_t>(i) * step_px);
    }
  }
  return row;
}

Result<void> write_png(const std::filesystem::path& path, const Picture& picture) {
  cv::Mat image(picture.height_px, picture.width_px, CV_8UC3);
  std::transform(picture.pixels.begin(), picture.pixels.end(), image.begin<cv::Vec3b>(),
                 [](const Rgb& color) { return cv::Vec3b(color[2], color[1], color[0]); });
  bool is_written = false;
  try {
    is_written = cv::imwrite(path.string(), image);
  } catch (const cv::Exception&) {
    is_written = false;
  }
  if (is_written) return {};
  return invalid("{}: can't be written; does the folder exist, is the disk full?", path.string());
}

}  // namespace graspd::simulation
