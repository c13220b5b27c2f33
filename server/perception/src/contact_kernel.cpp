#include "contact_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;
constexpr DF df;
constexpr DI di;

/// By how much rounding may make distances too great.
constexpr float kRounding_m = 1e-6F;

HWY_INLINE VF set(float value) { return hn::Set(df, value); }

/// A place along one axis of the grid.
struct Place {
  VI cell;
  VF off_centre_m;
};

std::size_t find_spheres_near(const SphereSpan& spheres, const KernelPose& T_grid_sphere,
                              const DistanceSpan& grid, float distance_m, SphereIndices& near) {
  const float cell_m = 1 / grid.cells_per_m;
  const auto place = [&](int axis, VF x, VF y, VF z) {
    const float* R = T_grid_sphere.R + 3 * axis;
    const auto p_m = hn::MulAdd(
        set(R[0]), x,
        hn::MulAdd(set(R[1]), y,
                   hn::MulAdd(set(R[2]), z, set(T_grid_sphere.t_m[axis] - grid.origin_m[axis]))));
    const auto low = hn::Floor(hn::Mul(p_m, set(grid.cells_per_m)));
    const auto centre_m = hn::Mul(hn::Add(low, set(0.5F)), set(cell_m));
    return Place{hn::ConvertTo(di, low), hn::Sub(p_m, centre_m)};
  };
  const auto is_in = [&](int axis, VI cell) {
    return hn::And(hn::Gt(cell, hn::Set(di, -1)), hn::Lt(cell, hn::Set(di, grid.size[axis])));
  };
  const auto within = set(distance_m + kRounding_m);
  const auto width = hn::Set(di, grid.size[0]);
  const auto height = hn::Set(di, grid.size[1]);
  std::size_t near_n = 0;
  for (std::uint32_t k = 0; k < spheres.size; k += static_cast<std::uint32_t>(hn::Lanes(df))) {
    const std::uint32_t i = spheres.first + k;
    const auto sphere_x = hn::LoadU(df, spheres.x_m + i);
    const auto sphere_y = hn::LoadU(df, spheres.y_m + i);
    const auto sphere_z = hn::LoadU(df, spheres.z_m + i);
    const Place x = place(0, sphere_x, sphere_y, sphere_z);
    const Place y = place(1, sphere_x, sphere_y, sphere_z);
    const Place z = place(2, sphere_x, sphere_y, sphere_z);
    const auto inside = hn::And(is_in(0, x.cell), hn::And(is_in(1, y.cell), is_in(2, z.cell)));
    if (hn::AllFalse(di, inside)) continue;
    const auto cell = hn::Add(hn::Mul(hn::Add(hn::Mul(z.cell, height), y.cell), width), x.cell);
    const auto from_centre_m =
        hn::GatherIndex(df, grid.distance_m, hn::IfThenElseZero(inside, cell));  // cell 0 is far
    const auto off2_m2 = hn::MulAdd(
        x.off_centre_m, x.off_centre_m,
        hn::MulAdd(y.off_centre_m, y.off_centre_m, hn::Mul(z.off_centre_m, z.off_centre_m)));
    const auto least_m = hn::Sub(from_centre_m, hn::Sqrt(off2_m2));
    const auto reach_m = hn::Add(hn::LoadU(df, spheres.radius_m + i), within);
    const auto is_near = hn::And(hn::And(hn::Le(least_m, reach_m), hn::RebindMask(df, inside)),
                                 hn::FirstN(df, spheres.size - k));
    const auto index = hn::Iota(di, static_cast<std::int32_t>(i));
    near_n += hn::CompressStore(index, hn::RebindMask(di, is_near), di,
                                reinterpret_cast<std::int32_t*>(near.values) + near_n);
  }
  return near_n;
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(find_spheres_near);
std::size_t find_spheres_near(const SphereSpan& spheres, const KernelPose& T_grid_sphere,
                              const DistanceSpan& grid, float distance_m, SphereIndices& near) {
  return HWY_DYNAMIC_DISPATCH(find_spheres_near)(spheres, T_grid_sphere, grid, distance_m, near);
}
}  // namespace graspd::perception
#endif
