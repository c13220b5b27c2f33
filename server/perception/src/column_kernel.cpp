#include "column_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "column_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
constexpr DF df;
constexpr DI di;

void find_columns(const PointSpan& points, const KernelPose& T_floor_part, const ColumnGrid& grid,
                  PointColumns& placed) {
  const auto set = [](float value) { return hn::Set(df, value); };
  const auto per_m = set(grid.columns_per_m);
  const auto column = [&](auto p_m, float first, std::int32_t columns_n) {
    const auto at = hn::MulSub(p_m, per_m, set(first));
    const auto last = hn::Set(di, columns_n - 1);
    // What is above 0 is rounded down.
    return hn::Min(hn::Max(hn::ConvertTo(di, at), hn::Zero(di)), last);
  };
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(df)) {
    const auto along = [&](int axis) {
      const float* R = T_floor_part.R + 3 * axis;
      return hn::MulAdd(set(R[0]), hn::LoadU(df, points.x_m + i),
                        hn::MulAdd(set(R[1]), hn::LoadU(df, points.y_m + i),
                                   hn::MulAdd(set(R[2]), hn::LoadU(df, points.z_m + i),
                                              set(T_floor_part.t_m[axis]))));
    };
    const auto x = column(along(0), grid.x_first, grid.width);
    const auto y = column(along(1), grid.y_first, grid.height);
    hn::StoreU(hn::Add(hn::Mul(y, hn::Set(di, grid.width)), x), di, placed.column + i);
    hn::StoreU(along(2), df, placed.z_m + i);
  }
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(find_columns);
void find_columns(const PointSpan& points, const KernelPose& T_floor_part, const ColumnGrid& grid,
                  PointColumns& placed) {
  HWY_DYNAMIC_DISPATCH(find_columns)(points, T_floor_part, grid, placed);
}
}  // namespace graspd::perception
#endif
