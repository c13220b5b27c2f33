#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plane_fit_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "plane_fit_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kStep_m = 0.008F;  ///< farther than this is another surface
constexpr float kMinCells = 12;
constexpr float kMaxCurvature = 1.0F / 3;

using Lanes = hn::ScalableTag<float>;
using Vec = hn::Vec<Lanes>;

/// Sums over the neighbours at (x, y) pixels from the cell whose depth differs by d.
struct Sums {
  Vec n, x, y, xx, xy, yy, d, xd, yd, dd;
};

HWY_INLINE Sums sums_at(Lanes df, const float* z_m, std::size_t stride, Vec z) {
  const Vec zero = hn::Zero(df);
  Sums sums{zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  for (int y = -kFitReach_px; y <= kFitReach_px; ++y) {
    const float* there = z_m + y * static_cast<std::ptrdiff_t>(stride);
    Vec n = zero, x_sum = zero, xx = zero, d_sum = zero, xd = zero;
    for (int x = -kFitReach_px; x <= kFitReach_px; ++x) {
      // No reading, 0, is as far away as another surface.
      const Vec difference = hn::Sub(hn::LoadU(df, there + x), z);
      const auto same = hn::Le(hn::Abs(difference), hn::Set(df, kStep_m));
      const Vec one = hn::IfThenElseZero(same, hn::Set(df, 1.0F));
      const Vec d = hn::IfThenElseZero(same, difference);
      const Vec at = hn::Set(df, static_cast<float>(x));
      n = hn::Add(n, one);
      x_sum = hn::MulAdd(at, one, x_sum);
      xx = hn::MulAdd(hn::Set(df, static_cast<float>(x * x)), one, xx);
      d_sum = hn::Add(d_sum, d);
      xd = hn::MulAdd(at, d, xd);
      sums.dd = hn::MulAdd(d, d, sums.dd);
    }
    const Vec at = hn::Set(df, static_cast<float>(y));
    sums.n = hn::Add(sums.n, n);
    sums.x = hn::Add(sums.x, x_sum);
    sums.xx = hn::Add(sums.xx, xx);
    sums.d = hn::Add(sums.d, d_sum);
    sums.xd = hn::Add(sums.xd, xd);
    sums.y = hn::MulAdd(at, n, sums.y);
    sums.xy = hn::MulAdd(at, x_sum, sums.xy);
    sums.yy = hn::MulAdd(hn::Mul(at, at), n, sums.yy);
    sums.yd = hn::MulAdd(at, d_sum, sums.yd);
  }
  return sums;
}

void fit_row(const FitRow& row) {
  const Lanes df;
  const Vec one = hn::Set(df, 1.0F);
  for (std::size_t u = 0; u < row.width; u += hn::Lanes(df)) {
    const Vec z = hn::LoadU(df, row.z_m + u);
    const Sums sums = sums_at(df, row.z_m + u, row.stride, z);
    const Vec per_cell = hn::Div(one, sums.n);
    const auto variance = [&](Vec ab, Vec a, Vec b) {
      return hn::NegMulAdd(hn::Mul(a, per_cell), b, ab);
    };
    const Vec xx = variance(sums.xx, sums.x, sums.x);
    const Vec xy = variance(sums.xy, sums.x, sums.y);
    const Vec yy = variance(sums.yy, sums.y, sums.y);
    const Vec xd = variance(sums.xd, sums.x, sums.d);
    const Vec yd = variance(sums.yd, sums.y, sums.d);
    const Vec dd = variance(sums.dd, sums.d, sums.d);
    const Vec determinant = hn::Sub(hn::Mul(xx, yy), hn::Mul(xy, xy));
    const Vec slope_x = hn::Div(hn::Sub(hn::Mul(yy, xd), hn::Mul(xy, yd)), determinant);
    const Vec slope_y = hn::Div(hn::Sub(hn::Mul(xx, yd), hn::Mul(xy, xd)), determinant);
    const auto fitted = hn::And(
        hn::Gt(z, hn::Zero(df)),
        hn::And(hn::Ge(sums.n, hn::Set(df, kMinCells)), hn::Gt(determinant, hn::Set(df, 0.5F))));

    // From depth per pixel to the surface's slope.
    const Vec gx = hn::Div(hn::Mul(slope_x, hn::Set(df, row.fx_px)), z);
    const Vec gy = hn::Div(hn::Mul(slope_y, hn::Set(df, row.fy_px)), z);
    const Vec ray_x = hn::Div(hn::Sub(hn::Iota(df, static_cast<float>(u)), hn::Set(df, row.cx_px)),
                              hn::Set(df, row.fx_px));
    const Vec gz = hn::Neg(hn::MulAdd(gx, ray_x, hn::MulAdd(gy, hn::Set(df, row.ray_y), one)));
    const Vec slope2 = hn::MulAdd(gx, gx, hn::Mul(gy, gy));
    const Vec length = hn::Sqrt(hn::MulAdd(gz, gz, slope2));
    const auto component = [&](Vec g) { return hn::IfThenElseZero(fitted, hn::Div(g, length)); };
    hn::StoreInterleaved3(component(gx), component(gy), component(gz), df, row.normals + 3 * u);

    const Vec pixel_x = hn::Div(z, hn::Set(df, row.fx_px));
    const Vec pixel_y = hn::Div(z, hn::Set(df, row.fy_px));
    const Vec all =
        hn::MulAdd(hn::Mul(pixel_x, pixel_x), xx, hn::MulAdd(hn::Mul(pixel_y, pixel_y), yy, dd));
    const Vec residual =
        hn::Max(hn::Zero(df), hn::Sub(dd, hn::MulAdd(slope_x, xd, hn::Mul(slope_y, yd))));
    const Vec across = hn::Div(residual, hn::Add(one, slope2));
    hn::StoreU(
        hn::IfThenElseZero(fitted, hn::Min(hn::Set(df, kMaxCurvature), hn::Div(across, all))), df,
        row.curvatures + u);
  }
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(fit_row);
void fit_row(const FitRow& row) { HWY_DYNAMIC_DISPATCH(fit_row)(row); }
}  // namespace graspd::perception
#endif
