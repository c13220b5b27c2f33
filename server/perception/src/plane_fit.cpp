#include "graspd/perception/plane_fit.hpp"

#include "padded_image.hpp"
#include "plane_fit_kernel.hpp"

namespace graspd::perception {

void fit_planes(const std::vector<float>& z_m, const PixelGrid& pixels,
                std::vector<Eigen::Vector3f>& normals, std::vector<float>& curvatures) {
  const auto width = static_cast<std::size_t>(pixels.width_px);
  const PaddedImage padded_m(z_m, width, kFitReach_px, kFitPadding);
  normals.resize(z_m.size());
  curvatures.resize(z_m.size());
  std::vector<float> row_normals(3 * (width + kFitPadding));
  std::vector<float> row_curvatures(width + kFitPadding);
  for (std::size_t v = 0; v < padded_m.height(); ++v) {
    fit_row({padded_m.row(v), padded_m.stride(), width, pixels.fx_px, pixels.fy_px, pixels.cx_px,
             (static_cast<float>(v) - pixels.cy_px) / pixels.fy_px, row_normals.data(),
             row_curvatures.data()});
    const auto at = static_cast<std::ptrdiff_t>(v * width);
    std::copy_n(row_normals.begin(), 3 * width, normals[v * width].data());
    std::copy_n(row_curvatures.begin(), width, curvatures.begin() + at);
  }
}

}  // namespace graspd::perception
