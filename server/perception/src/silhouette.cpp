#include "graspd/perception/silhouette.hpp"

#include <algorithm>

namespace graspd::perception {
namespace {

constexpr std::size_t kEvery = 2;
/// Nearer to the camera than this, nothing projects to a sensible place.
constexpr float kNearestDrawn_m = 0.05F;
constexpr float kHalfPixel_px = 0.5F;

/// The rectangle around a ball; empty where it is not in the image.
void place(const Eigen::Vector3f& centre_m, float radius_m, int margin_px, const PixelGrid& image,
           Silhouette& silhouette) {
  silhouette.width = silhouette.height = 0;
  const float nearest_z_m = centre_m.z() - radius_m;
  if (nearest_z_m < kNearestDrawn_m) return;
  const float radius_px = radius_m / nearest_z_m * std::max(image.fx_px, image.fy_px);
  const auto reach_px = static_cast<int>(radius_px) + margin_px + 2;
  const auto u = static_cast<int>(centre_m.x() / centre_m.z() * image.fx_px + image.cx_px);
  const auto v = static_cast<int>(centre_m.y() / centre_m.z() * image.fy_px + image.cy_px);
  silhouette.u_first = std::max(1, u - reach_px);
  silhouette.v_first = std::max(1, v - reach_px);
  const int width = std::min(image.width_px - 2, u + reach_px) - silhouette.u_first + 1;
  const int height = std::min(image.height_px - 2, v + reach_px) - silhouette.v_first + 1;
  if (width <= 0 || height <= 0) return;
  silhouette.width = width;
  silhouette.height = height;
}

}  // namespace

void Silhouette::smear(int by_px) {
  // The least of a square: first along the rows, then along the columns.
  rows_m.assign(nearest_m.size(), kNone_m);
  for (int y = 0; y < height; ++y) {
    const float* from = row(y);
    float* to = &rows_m[static_cast<std::size_t>(y) * width];
    for (int shift = -by_px; shift <= by_px; ++shift) {
      const int last = std::min(width, width - shift);
      for (int x = std::max(0, -shift); x < last; ++x) to[x] = std::min(to[x], from[x + shift]);
    }
  }
  std::ranges::fill(nearest_m, kNone_m);
  for (int y = 0; y < height; ++y) {
    float* to = row(y);
    const int last = std::min(height - 1, y + by_px);
    for (int other = std::max(0, y - by_px); other <= last; ++other) {
      const float* from = &rows_m[static_cast<std::size_t>(other) * width];
      for (int x = 0; x < width; ++x) to[x] = std::min(to[x], from[x]);
    }
  }
}

void draw_silhouette(const PlacedPart& part, const Eigen::Isometry3d& T_camera_floor,
                     const PixelGrid& image, int smear_px, Silhouette& silhouette) {
  const Eigen::Isometry3f T_camera_part = (T_camera_floor * part.T_floor_part).cast<float>();
  const Eigen::Matrix3f R = T_camera_part.linear();
  const Eigen::Vector3f t_m = T_camera_part.translation();
  place(T_camera_part * part.part->barycentre_m.cast<float>(),
        static_cast<float>(part.part->radius_m), smear_px, image, silhouette);
  silhouette.nearest_m.assign(
      static_cast<std::size_t>(silhouette.width) * static_cast<std::size_t>(silhouette.height),
      Silhouette::kNone_m);
  if (silhouette.nearest_m.empty()) return;
  const float cx_px = image.cx_px - static_cast<float>(silhouette.u_first) + kHalfPixel_px;
  const float cy_px = image.cy_px - static_cast<float>(silhouette.v_first) + kHalfPixel_px;
  const auto& surface = part.part->surface;
  for (std::size_t i = 0; i < surface.size(); i += kEvery) {
    const Eigen::Vector3f p = R * surface[i].position_m + t_m;
    const float inverse_z = 1 / p.z();
    const auto u = static_cast<int>(p.x() * inverse_z * image.fx_px + cx_px);
    const auto v = static_cast<int>(p.y() * inverse_z * image.fy_px + cy_px);
    if (u < 0 || v < 0 || u >= silhouette.width || v >= silhouette.height) continue;
    float& nearest = silhouette.row(v)[u];
    nearest = std::min(nearest, p.z());
  }
  silhouette.smear(smear_px);
}

}  // namespace graspd::perception
