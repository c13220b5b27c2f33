#include "depth_picture.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "canvas.hpp"
#include "graspd/types/camera_model.hpp"

namespace graspd::overlay {
namespace {

constexpr double kDarkest = 60;
constexpr double kBrightest = 225;
constexpr double kTails = 0.02;    // of the readings, at each end, that may be out of the contrast
constexpr double kStrays = 0.005;  // of the readings, at each edge, that may be out of the view
constexpr std::size_t kFewReadings = 200;
constexpr int kViewMargin_px = 10;
constexpr int kWidth_px = 1100;

/// The box that the contrast is made for, or none.
struct Region {
  Eigen::Isometry3d T_region_camera = Eigen::Isometry3d::Identity();
  Eigen::AlignedBox3d box;

  bool contains(const Eigen::Vector3d& p_camera) const {
    return box.contains(T_region_camera * p_camera);
  }
};

std::optional<Region> region_of(const PlanRequest& request) {
  if (request.bin) {
    const Eigen::Vector3d half = request.bin->inner_size_m / 2;
    return Region{request.bin->T_base_bin.inverse() * request.T_base_camera,
                  {Eigen::Vector3d(-half.x(), -half.y(), -0.01),
                   Eigen::Vector3d(half.x(), half.y(), 2 * half.z())}};
  }
  if (request.crop_box) {
    const Eigen::Vector3d half = request.crop_box->size_m / 2;
    return Region{request.crop_box->T_base_box.inverse() * request.T_base_camera, {-half, half}};
  }
  return std::nullopt;
}

struct Pixel {
  int u_px;
  int v_px;
  std::uint16_t reading;
};

std::vector<Pixel> readings_in(const DepthFrame& frame, const std::optional<Region>& region) {
  std::vector<Pixel> pixels;
  for (int v = 0; v < frame.camera.height_px; ++v) {
    for (int u = 0; u < frame.camera.width_px; ++u) {
      const std::uint16_t reading = frame.at(u, v);
      if (reading == 0) continue;
      const double z_m = reading * frame.depth_scale_m;
      if (!region || region->contains(z_m * ray_through(frame.camera, u, v))) {
        pixels.push_back({u, v, reading});
      }
    }
  }
  return pixels;
}

/// What the picture is about.
std::vector<Pixel> content(const DepthFrame& frame, const PlanRequest& request) {
  std::vector<Pixel> pixels = readings_in(frame, region_of(request));
  if (pixels.size() < kFewReadings) pixels = readings_in(frame, std::nullopt);
  return pixels;
}

/// The range of a quantity of pixels, without the tails.
template <class Quantity>
std::pair<int, int> range_of(const std::vector<Pixel>& pixels, double tail, Quantity quantity) {
  std::vector<int> values;
  values.reserve(pixels.size());
  for (const Pixel& pixel : pixels) values.push_back(quantity(pixel));
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(tail * static_cast<double>(values.size()));
  return {values[cut], values[values.size() - 1 - cut]};
}

/// [first, last] widened by the margin and to the least size, within 0 … size.
std::pair<int, int> widened(std::pair<int, int> range, int size_px) {
  const int length_px = std::max(range.second - range.first + 1 + 2 * kViewMargin_px, size_px / 4);
  const int centre_px = (range.first + range.second) / 2;
  const int begin_px = std::clamp(centre_px - length_px / 2, 0, size_px - 1);
  return {begin_px, std::min(begin_px + length_px, size_px)};
}

}  // namespace

View view_of(const DepthFrame& frame, const PlanRequest& request) {
  const std::vector<Pixel> pixels = content(frame, request);
  if (pixels.empty()) return {0, 0, frame.camera.width_px, frame.camera.height_px, 2};
  const auto u = range_of(pixels, kStrays, [](const Pixel& pixel) { return pixel.u_px; });
  const auto v = range_of(pixels, kStrays, [](const Pixel& pixel) { return pixel.v_px; });
  const auto [left_px, right_px] = widened(u, frame.camera.width_px);
  const auto [top_px, bottom_px] = widened(v, frame.camera.height_px);
  const int scale = std::clamp(kWidth_px / (right_px - left_px), 2, 5);
  return {left_px, top_px, right_px - left_px, bottom_px - top_px, scale};
}

cv::Mat depth_picture(const DepthFrame& frame, const PlanRequest& request, const View& view) {
  const std::vector<Pixel> pixels = content(frame, request);
  int near = 0;
  int far = 1;
  if (!pixels.empty()) {
    std::tie(near, far) =
        range_of(pixels, kTails, [](const Pixel& pixel) { return int{pixel.reading}; });
    far = std::max(far, near + 1);
  }
  cv::Mat picture(view.height_px, view.width_px, CV_8UC3, bgr(kNoReadingColor));
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const int reading = frame.at(view.left_px + x, view.top_px + y);
      if (reading == 0) continue;
      const double nearness = std::clamp(static_cast<double>(far - reading) / (far - near), 0., 1.);
      const auto grey = cv::saturate_cast<uchar>(kDarkest + nearness * (kBrightest - kDarkest));
      picture.at<cv::Vec3b>(y, x) = {grey, grey, grey};
    }
  }
  cv::resize(picture, picture, {}, view.scale, view.scale, cv::INTER_NEAREST);
  return picture;
}

}  // namespace graspd::overlay
