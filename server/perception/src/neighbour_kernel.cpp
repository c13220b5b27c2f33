#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "neighbour_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "neighbour_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<float>;
using Vec = hn::Vec<Lanes>;

struct Points {
  Vec x, y, z;

  Points(Lanes df, const PointRows& rows, std::ptrdiff_t at)
      : x(hn::LoadU(df, rows.x_m + at)),
        y(hn::LoadU(df, rows.y_m + at)),
        z(hn::LoadU(df, rows.z_m + at)) {}
  Points(Lanes df, const float p_m[3])
      : x(hn::Set(df, p_m[0])), y(hn::Set(df, p_m[1])), z(hn::Set(df, p_m[2])) {}
};

HWY_INLINE auto is_within(const Points& a, const Points& b, Vec radius2) {
  const Vec x = hn::Sub(a.x, b.x);
  const Vec y = hn::Sub(a.y, b.y);
  const Vec z = hn::Sub(a.z, b.z);
  return hn::Le(hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), hn::Mul(z, z))), radius2);
}

std::size_t ids_within(const PointRows& points, const std::uint32_t* ids, std::size_t count,
                       const float p_m[3], float radius2_m2, std::uint32_t* found) {
  const Lanes df;
  const hn::RebindToUnsigned<Lanes> du;
  const Points p(df, p_m);
  std::size_t found_n = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
    const auto within =
        is_within(Points(df, points, static_cast<std::ptrdiff_t>(i)), p, hn::Set(df, radius2_m2));
    const auto wanted = hn::And(within, hn::FirstN(df, count - i));
    // Not CompressStore, which takes Zen 4 a hundred cycles.
    hn::StoreU(hn::Compress(hn::LoadU(du, ids + i), hn::RebindMask(du, wanted)), du,
               found + found_n);
    found_n += hn::CountTrue(df, wanted);
  }
  return found_n;
}

void mark_neighbours(const PointRows& row, const PointRows& others, std::size_t width,
                     const std::ptrdiff_t* offsets, std::size_t offsets_n, float radius2_m2,
                     std::uint32_t* masks, std::int32_t* counts) {
  const Lanes df;
  const hn::RebindToUnsigned<Lanes> du;
  const hn::RebindToSigned<Lanes> di;
  for (std::size_t u = 0; u < width; u += hn::Lanes(df)) {
    const auto at = static_cast<std::ptrdiff_t>(u);
    const Points here(df, row, at);
    auto mask = hn::Zero(du);
    auto count = hn::LoadU(di, counts + u);
    for (std::size_t t = 0; t < offsets_n; ++t) {
      const auto within =
          is_within(here, Points(df, others, at + offsets[t]), hn::Set(df, radius2_m2));
      mask = hn::Or(
          mask, hn::IfThenElseZero(hn::RebindMask(du, within), hn::Set(du, std::uint32_t{1} << t)));
      count = hn::Sub(count, hn::BitCast(di, hn::VecFromMask(df, within)));
    }
    hn::StoreU(mask, du, masks + u);
    hn::StoreU(count, di, counts + u);
  }
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(ids_within);
HWY_EXPORT(mark_neighbours);

std::size_t ids_within(const PointRows& points, const std::uint32_t* ids, std::size_t count,
                       const float p_m[3], float radius2_m2, std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(ids_within)(points, ids, count, p_m, radius2_m2, found);
}
void mark_neighbours(const PointRows& row, const PointRows& others, std::size_t width,
                     const std::ptrdiff_t* offsets, std::size_t offsets_n, float radius2_m2,
                     std::uint32_t* masks, std::int32_t* counts) {
  HWY_DYNAMIC_DISPATCH(mark_neighbours)
  (row, others, width, offsets, offsets_n, radius2_m2, masks, counts);
}
}  // namespace graspd::perception
#endif
