#include "gaussian.hpp"

#include <algorithm>
#include <cmath>

namespace graspd::simulation {

std::vector<float> gaussian_kernel(double sigma_px) {
  if (!(sigma_px > 0)) return {1};
  const int radius = int(std::ceil(3 * sigma_px));
  std::vector<float> kernel;
  float sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    kernel.push_back(float(std::exp(-0.5 * i * i / (sigma_px * sigma_px))));
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

std::vector<float> convolve(const std::vector<float>& image, int width_px, int height_px,
                            const std::vector<float>& kernel) {
  const int radius = int(kernel.size()) / 2;
  const auto at = [width_px](int u, int v) {
    return std::size_t(v) * std::size_t(width_px) + std::size_t(u);
  };
  std::vector<float> rows(image.size(), 0);
  for (int v = 0; v < height_px; ++v) {
    int k = -radius;
    for (const float weight : kernel) {
      for (int u = std::max(0, -k); u < std::min(width_px, width_px - k); ++u) {
        rows[at(u, v)] += weight * image[at(u + k, v)];
      }
      ++k;
    }
  }
  std::vector<float> result(image.size(), 0);
  for (int v = 0; v < height_px; ++v) {
    int from = v - radius;
    for (const float weight : kernel) {
      if (from >= 0 && from < height_px) {
        for (int u = 0; u < width_px; ++u) result[at(u, v)] += weight * rows[at(u, from)];
      }
      ++from;
    }
  }
  return result;
}

}  // namespace graspd::simulation
