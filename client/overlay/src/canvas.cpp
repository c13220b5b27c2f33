#include "canvas.hpp"

#include <opencv2/imgproc.hpp>

namespace graspd::overlay {
namespace {

constexpr double kFontHeight_px = 22;  // of capitals at scale 1
// Sixteenths of a pixel, so that lines do not jump.
constexpr int kShift = 4;
const Color kRim{0, 0, 0};

std::vector<cv::Point> fixed_point(const std::vector<cv::Point2d>& points) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const cv::Point2d& point : points) {
    fixed.emplace_back(cvRound(point.x * (1 << kShift)), cvRound(point.y * (1 << kShift)));
  }
  return fixed;
}

/// Large text in the face with double strokes.
int font(double height_px) {
  return height_px >= 12 ? cv::FONT_HERSHEY_DUPLEX : cv::FONT_HERSHEY_SIMPLEX;
}

/// OpenCV's fonts know ASCII only.
std::string ascii(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;
    plain += byte < 0x80 ? c : '?';
  }
  return plain;
}

}  // namespace

void draw_line(cv::Mat& picture, const std::vector<cv::Point2d>& points, bool closed,
               const Color& color, int thickness_px) {
  if (points.size() < 2) return;
  const std::vector<std::vector<cv::Point>> lines{fixed_point(points)};
  cv::polylines(picture, lines, closed, bgr(kRim), thickness_px + 2, cv::LINE_AA, kShift);
  cv::polylines(picture, lines, closed, bgr(color), thickness_px, cv::LINE_AA, kShift);
}

void fill_polygon(cv::Mat& picture, const std::vector<cv::Point2d>& corners, const Color& color) {
  const std::vector<std::vector<cv::Point>> polygons{fixed_point(corners)};
  cv::fillPoly(picture, polygons, bgr(color), cv::LINE_AA, kShift);
  cv::polylines(picture, polygons, true, bgr(kRim), 1, cv::LINE_AA, kShift);
}

void draw_label(cv::Mat& picture, const std::string& text, cv::Point2d centre, double height_px,
                const Color& color) {
  const int width_px = text_width_px(text, height_px);
  const cv::Point left_bottom(cvRound(centre.x) - width_px / 2, cvRound(centre.y + height_px / 2));
  const cv::Point margin(3, 3);
  cv::rectangle(picture, left_bottom + cv::Point(-margin.x, margin.y),
                left_bottom + cv::Point(width_px + margin.x, -cvRound(height_px) - margin.y),
                bgr(kRim), cv::FILLED);
  draw_text(picture, text, left_bottom, height_px, color);
}

int draw_text(cv::Mat& picture, const std::string& text, cv::Point left_bottom, double height_px,
              const Color& color) {
  cv::putText(picture, ascii(text), left_bottom, font(height_px), height_px / kFontHeight_px,
              bgr(color), 1, cv::LINE_AA);
  return text_width_px(text, height_px);
}

int text_width_px(const std::string& text, double height_px) {
  int baseline = 0;
  const double scale = height_px / kFontHeight_px;
  return cv::getTextSize(ascii(text), font(height_px), scale, 1, &baseline).width;
}

}  // namespace graspd::overlay
