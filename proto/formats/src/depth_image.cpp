#include "graspd/formats/depth_image.hpp"

#include <opencv2/imgcodecs.hpp>

namespace graspd {

Result<Image16> read_png16(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) {
    return invalid("{}: no such file", path.string());
  }
  cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  if (image.empty()) return invalid("{}: damaged, or not an image", path.string());
  if (image.type() == CV_8UC1) image.convertTo(image, CV_16UC1);
  if (image.type() != CV_16UC1) {
    return invalid("{}: {} channels of {} bytes; a depth image has one channel of 16 bits",
                   path.string(), image.channels(), image.elemSize1());
  }
  Image16 result{image.cols, image.rows, {}};
  result.values.assign(image.begin<std::uint16_t>(), image.end<std::uint16_t>());
  return result;
}

Result<void> write_png16(const std::filesystem::path& path, const Image16& image) {
  // cv::Mat has no read-only view.
  auto* values = const_cast<std::uint16_t*>(image.values.data());
  const cv::Mat view(image.height_px, image.width_px, CV_16UC1, values);
  bool written = false;
  try {
    written = cv::imwrite(path.string(), view);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    return invalid("{}: can't be written; does the folder exist, is the disk full?", path.string());
  }
  return {};
}

}  // namespace graspd
