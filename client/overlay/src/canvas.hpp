#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace graspd::overlay {

using Color = std::array<std::uint8_t, 3>;  ///< red, green, blue

inline cv::Scalar bgr(const Color& color) {
  return {static_cast<double>(color[2]), static_cast<double>(color[1]),
          static_cast<double>(color[0])};
}

/// A line with a dark rim, so that it shows on light and dark ground alike.
void draw_line(cv::Mat& picture, const std::vector<cv::Point2d>& points, bool closed,
               const Color& color, int thickness_px);
void fill_polygon(cv::Mat& picture, const std::vector<cv::Point2d>& corners, const Color& color);
/// Text on a dark plate, centred. Letters beyond ASCII show as '?'.
void draw_label(cv::Mat& picture, const std::string& text, cv::Point2d centre, double height_px,
                const Color& color);
/// Plain text from the left. \returns its width.
int draw_text(cv::Mat& picture, const std::string& text, cv::Point left_bottom, double height_px,
              const Color& color);
int text_width_px(const std::string& text, double height_px);

}  // namespace graspd::overlay
