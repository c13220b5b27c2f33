#include "graspd/perception/plane_fit.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "padded_image.hpp"
#include "parallel.hpp"
#include "plane_fit_kernel.hpp"

namespace graspd::perception {
namespace {

/// Working memory of one thread: a row with what vectors write beyond its end.
struct FittedRow {
  explicit FittedRow(std::size_t width)
      : normals(3 * (width + kFitPadding)), curvatures(width + kFitPadding) {}
  std::vector<float> normals, curvatures;
};

}  // namespace

void fit_planes(const std::vector<float>& z_m, const PixelGrid& pixels,
                std::vector<Eigen::Vector3f>& normals, std::vector<float>& curvatures) {
  const auto width = static_cast<std::size_t>(pixels.width_px);
  const PaddedImage padded_m(z_m, width, kFitReach_px, kFitPadding);
  normals.resize(z_m.size());
  curvatures.resize(z_m.size());
  tbb::enumerable_thread_specific<FittedRow> memory(width);
  parallel_for(padded_m.height(), [&](std::size_t v) {
    FittedRow& fitted = memory.local();
    fit_row({padded_m.row(v), padded_m.stride(), width, pixels.fx_px, pixels.fy_px, pixels.cx_px,
             (static_cast<float>(v) - pixels.cy_px) / pixels.fy_px, fitted.normals.data(),
             fitted.curvatures.data()});
    const auto at = static_cast<std::ptrdiff_t>(v * width);
    std::copy_n(fitted.normals.begin(), 3 * width, normals[v * width].data());
    std::copy_n(fitted.curvatures.begin(), width, curvatures.begin() + at);
  });
}

}  // namespace graspd::perception
