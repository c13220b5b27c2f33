#include <algorithm>
#include <cmath>
#include <cstddef>

#include "graspd/perception/depth_grid.hpp"

namespace graspd::perception {
namespace {

/// The surroundings are wide, so they are summed up by cells of this many pixels.
constexpr int kCell_px = 8;
/// Slopes are taken over this many pixels to either side, as wide as the sensor's own blur.
constexpr int kReach_px = 3;
/// Steeper than 60° the slope is too uncertain to divide by.
constexpr float kMinCosine2 = 0.25F;

struct Image {
  int width, height;
  std::vector<float> values;

  Image(int width_n, int height_n)
      : width(width_n),
        height(height_n),
        values(static_cast<std::size_t>(width_n) * static_cast<std::size_t>(height_n), 0) {}
  float& at(int x, int y) { return values[static_cast<std::size_t>(y * width + x)]; }
  float at(int x, int y) const { return values[static_cast<std::size_t>(y * width + x)]; }

  /// At a place between the values' own, whole numbers at their centres.
  float between(float x, float y) const {
    const int x0 = std::clamp(static_cast<int>(x), 0, std::max(0, width - 2));
    const int y0 = std::clamp(static_cast<int>(y), 0, std::max(0, height - 2));
    const int x1 = std::min(x0 + 1, width - 1);
    const int y1 = std::min(y0 + 1, height - 1);
    const float fx = std::clamp(x - static_cast<float>(x0), 0.0F, 1.0F);
    const float fy = std::clamp(y - static_cast<float>(y0), 0.0F, 1.0F);
    return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x1, y0)) +
           fy * ((1 - fx) * at(x0, y1) + fx * at(x1, y1));
  }
};

std::vector<float> gaussian(double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> kernel;
  float sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma))));
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

void blur(Image& image, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size() / 2);
  const auto pass = [&](int dx, int dy) {
    Image result(image.width, image.height);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const int at = dx * x + dy * y;
        const int last = dx * (image.width - 1) + dy * (image.height - 1);
        for (int i = std::max(-reach, -at); i <= std::min(reach, last - at); ++i) {
          result.at(x, y) +=
              kernel[static_cast<std::size_t>(i + reach)] * image.at(x + dx * i, y + dy * i);
        }
      }
    }
    image = std::move(result);
  };
  pass(1, 0);
  pass(0, 1);
}

/// Depth per pixel. Each side is looked at by itself: across an edge only the side on the pixel's
/// own surface counts.
float slope(const float* z_m, std::ptrdiff_t along, std::ptrdiff_t across) {
  constexpr int kRows = 2;
  float side[2] = {0, 0};
  for (const int sign : {-1, 1}) {
    float sum = 0;
    int count = 0;
    for (int k = -kRows; k <= kRows; ++k) {
      const float here = z_m[k * across];
      const float there = z_m[k * across + sign * kReach_px * along];
      if (here <= 0 || there <= 0) continue;
      sum += static_cast<float>(sign) * (there - here);
      ++count;
    }
    if (count > 0) side[(sign + 1) / 2] = sum / static_cast<float>(count * kReach_px);
  }
  const float mean = (side[0] + side[1]) / 2;
  const float flatter = std::abs(side[0]) < std::abs(side[1]) ? side[0] : side[1];
  return std::abs(flatter) * 2 > std::abs(mean) ? mean : flatter;
}

/// cos²(incidence) / z² at each pixel.
Image brightness(const std::vector<float>& z_m, int width, int height, float f_px) {
  Image light(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v * width + u);
      if (z_m[i] <= 0) continue;
      const bool inside =
          u >= kReach_px && v >= kReach_px && u < width - kReach_px && v < height - kReach_px;
      const float gx = inside ? slope(z_m.data() + i, 1, width) * f_px / z_m[i] : 0;
      const float gy = inside ? slope(z_m.data() + i, width, 1) * f_px / z_m[i] : 0;
      light.at(u, v) = std::max(kMinCosine2, 1 / (1 + gx * gx + gy * gy)) / (z_m[i] * z_m[i]);
    }
  }
  return light;
}

}  // namespace

void remove_stray_light(const PreprocessParameters& parameters, int width_px, int height_px,
                        double f_px, std::vector<float>& z_m) {
  if (!(parameters.stray_light_share > 0)) return;
  const Image own = brightness(z_m, width_px, height_px, static_cast<float>(f_px));
  const int columns = (width_px + kCell_px - 1) / kCell_px;
  const int rows = (height_px + kCell_px - 1) / kCell_px;
  Image light(columns, rows), light_times_z(columns, rows);
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      const float share = own.at(u, v) / (kCell_px * kCell_px);
      light.at(u / kCell_px, v / kCell_px) += share;
      light_times_z.at(u / kCell_px, v / kCell_px) +=
          share * z_m[static_cast<std::size_t>(v * width_px + u)];
    }
  }
  const std::vector<float> kernel = gaussian(parameters.stray_light_sigma_px / kCell_px);
  blur(light, kernel);
  blur(light_times_z, kernel);

  const auto share = static_cast<float>(parameters.stray_light_share);
  for (int v = 0; v < height_px; ++v) {
    const float y = (static_cast<float>(v) + 0.5F) / kCell_px - 0.5F;
    for (int u = 0; u < width_px; ++u) {
      float& z = z_m[static_cast<std::size_t>(v * width_px + u)];
      if (z <= 0) continue;
      const float x = (static_cast<float>(u) + 0.5F) / kCell_px - 0.5F;
      // What was read: z · (own + share · light) = own · true z + share · light · its z.
      const float stray = share * (z * light.between(x, y) - light_times_z.between(x, y));
      z += stray / own.at(u, v);
    }
  }
}

}  // namespace graspd::perception
