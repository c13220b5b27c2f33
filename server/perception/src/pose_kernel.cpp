#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>

#include "graspd/perception/pose_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBlock = 16;

PoseCounts count_evidence(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                          float tolerance_m, const EarlyStop& stop) {
  const hn::CappedTag<float, kBlock> df;
  const hn::RebindToSigned<decltype(df)> di;
  const std::size_t lanes = hn::Lanes(df);
  const auto* cells = reinterpret_cast<const std::int32_t*>(depth.cells);
  const auto row = [&](int i, auto x, auto y, auto z) {
    return hn::MulAdd(
        hn::Set(df, pose.R[3 * i]), x,
        hn::MulAdd(hn::Set(df, pose.R[3 * i + 1]), y,
                   hn::MulAdd(hn::Set(df, pose.R[3 * i + 2]), z, hn::Set(df, pose.t_m[i]))));
  };
  const auto tolerance = hn::Set(df, tolerance_m / PackedDepth::kUnit_m);
  const auto zero = hn::Zero(di);
  const auto minus_one = hn::Set(di, -1);
  PoseCounts counts;
  auto error2_sum = hn::Zero(di);
  for (std::size_t block = 0; block < points.size; block += kBlock) {
    const std::size_t end = std::min(points.size, block + kBlock);
    for (std::size_t i = block; i < end; i += lanes) {
      const auto x = hn::LoadU(df, points.x_m + i);
      const auto y = hn::LoadU(df, points.y_m + i);
      const auto z = hn::LoadU(df, points.z_m + i);
      const auto pz = row(2, x, y, z);
      const auto inverse = hn::Div(hn::Set(df, 1.0F), pz);
      const auto u = hn::NearestInt(hn::MulAdd(hn::Mul(row(0, x, y, z), inverse),
                                               hn::Set(df, depth.fx_px), hn::Set(df, depth.cx_px)));
      const auto v = hn::NearestInt(hn::MulAdd(hn::Mul(row(1, x, y, z), inverse),
                                               hn::Set(df, depth.fy_px), hn::Set(df, depth.cy_px)));
      const auto inside =
          hn::And(hn::And(hn::Gt(u, minus_one), hn::Lt(u, hn::Set(di, depth.width_px))),
                  hn::And(hn::Gt(v, minus_one), hn::Lt(v, hn::Set(di, depth.height_px))));
      const auto index = hn::IfThenElseZero(
          inside, hn::Add(hn::Mul(v, hn::Set(di, depth.width_px)), u));  // cell 0 holds nothing
      const auto packed = hn::GatherIndex(di, cells, index);
      const auto reading = hn::And(packed, hn::Set(di, 0xFFFF));
      const auto nearest = hn::BitCast(
          di, hn::ShiftRight<16>(hn::BitCast(hn::RebindToUnsigned<decltype(di)>(), packed)));
      const auto expected = hn::Mul(pz, hn::Set(df, 1 / PackedDepth::kUnit_m));
      const auto error = hn::Sub(hn::ConvertTo(df, reading), expected);
      const auto nearest_error = hn::Sub(hn::ConvertTo(df, nearest), expected);
      const auto valid =
          hn::And(hn::RebindMask(df, hn::Gt(reading, zero)), hn::FirstN(df, end - i));
      const auto supports = hn::And(valid, hn::Le(hn::Abs(error), tolerance));
      const auto refutes = hn::And(valid, hn::Gt(nearest_error, tolerance));
      const auto hides = hn::And(valid, hn::Lt(error, hn::Neg(tolerance)));
      counts.support_n += static_cast<std::int32_t>(hn::CountTrue(df, supports));
      counts.refute_n += static_cast<std::int32_t>(hn::CountTrue(df, refutes));
      counts.hidden_n += static_cast<std::int32_t>(hn::CountTrue(df, hides));
      const auto whole_error = hn::NearestInt(hn::IfThenElseZero(supports, error));
      error2_sum = hn::Add(error2_sum, hn::Mul(whole_error, whole_error));
    }
    counts.tested_n = static_cast<std::int32_t>(end);
    if (block == 0 &&
        (counts.support_n < stop.min_support_n || counts.refute_n > stop.max_refute_n)) {
      break;
    }
  }
  counts.error2_sum = hn::GetLane(hn::SumOfLanes(di, error2_sum));
  return counts;
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(count_evidence);
PoseCounts count_evidence(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                          float tolerance_m, const EarlyStop& stop) {
  return HWY_DYNAMIC_DISPATCH(count_evidence)(depth, pose, points, tolerance_m, stop);
}
}  // namespace graspd::perception
#endif
