#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace graspd::perception {

/// An image with zeros around it, so that windows and whole vectors may reach beyond its border.
class PaddedImage {
 public:
  /// \param margin on every side; \param padding more at the end of each row.
  PaddedImage(std::size_t width, std::size_t height, std::size_t margin, std::size_t padding)
      : width_(width),
        height_(height),
        margin_(margin),
        stride_(width + 2 * margin + padding),
        values_(stride_ * (height + 2 * margin), 0) {}
  PaddedImage(const std::vector<float>& values, std::size_t width, std::size_t margin,
              std::size_t padding)
      : PaddedImage(width, values.size() / width, margin, padding) {
    for (std::size_t v = 0; v < height_; ++v) {
      std::copy_n(values.data() + v * width, width, row(v));
    }
  }

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  std::size_t stride() const { return stride_; }
  float* row(std::size_t v) { return values_.data() + (v + margin_) * stride_ + margin_; }
  const float* row(std::size_t v) const {
    return values_.data() + (v + margin_) * stride_ + margin_;
  }

 private:
  std::size_t width_, height_, margin_, stride_;
  std::vector<float> values_;
};

}  // namespace graspd::perception
