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

using DF = hn::CappedTag<float, kBlock>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;
constexpr DF df;
constexpr DI di;

struct Vector3 {
  VF x, y, z;
};

HWY_INLINE Vector3 rotate(const KernelPose& pose, const Vector3& p) {
  const auto row = [&](int i) {
    return hn::MulAdd(hn::Set(df, pose.R[3 * i]), p.x,
                      hn::MulAdd(hn::Set(df, pose.R[3 * i + 1]), p.y,
                                 hn::Mul(hn::Set(df, pose.R[3 * i + 2]), p.z)));
  };
  return {row(0), row(1), row(2)};
}

HWY_INLINE Vector3 load(const float* x, const float* y, const float* z, std::size_t i) {
  return {hn::LoadU(df, x + i), hn::LoadU(df, y + i), hn::LoadU(df, z + i)};
}

HWY_INLINE Vector3 in_camera(const KernelPose& pose, const PointSpan& points, std::size_t i) {
  const Vector3 p = rotate(pose, load(points.x_m, points.y_m, points.z_m, i));
  return {hn::Add(p.x, hn::Set(df, pose.t_m[0])), hn::Add(p.y, hn::Set(df, pose.t_m[1])),
          hn::Add(p.z, hn::Set(df, pose.t_m[2]))};
}

/// The cells that points project to; 0, which holds nothing, for the outermost ones and beyond.
/// \param inverse_z of the points.
HWY_INLINE VI cells_of(const PackedDepth& depth, const Vector3& p, VF inverse_z) {
  const auto u = hn::NearestInt(
      hn::MulAdd(hn::Mul(p.x, inverse_z), hn::Set(df, depth.fx_px), hn::Set(df, depth.cx_px)));
  const auto v = hn::NearestInt(
      hn::MulAdd(hn::Mul(p.y, inverse_z), hn::Set(df, depth.fy_px), hn::Set(df, depth.cy_px)));
  const auto zero = hn::Zero(di);
  const auto inside =
      hn::And(hn::And(hn::Gt(u, zero), hn::Lt(u, hn::Set(di, depth.width_px - 1))),
              hn::And(hn::Gt(v, zero), hn::Lt(v, hn::Set(di, depth.height_px - 1))));
  return hn::IfThenElseZero(inside, hn::Add(hn::Mul(v, hn::Set(di, depth.width_px)), u));
}

HWY_INLINE VI packed_at(const PackedDepth& depth, VI cells) {
  return hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(depth.cells), cells);
}

HWY_INLINE VI low_half(VI packed) { return hn::And(packed, hn::Set(di, 0xFFFF)); }
HWY_INLINE VI high_half(VI packed) {
  return hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(hn::RebindToUnsigned<DI>(), packed)));
}

PoseCounts count_evidence(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                          float tolerance_m, const EarlyStop& stop) {
  const auto tolerance = hn::Set(df, tolerance_m / PackedDepth::kUnit_m);
  const auto zero = hn::Zero(di);
  const auto count = [](auto mask) { return static_cast<std::int32_t>(hn::CountTrue(df, mask)); };
  PoseCounts counts;
  auto error2_sum = hn::Zero(di);
  for (std::size_t block = 0; block < points.size; block += kBlock) {
    const std::size_t end = std::min(points.size, block + kBlock);
    for (std::size_t i = block; i < end; i += hn::Lanes(df)) {
      const Vector3 p = in_camera(pose, points, i);
      const auto packed = packed_at(depth, cells_of(depth, p, hn::Div(hn::Set(df, 1.0F), p.z)));
      const auto reading = low_half(packed);
      const auto nearest = high_half(packed);
      const auto expected = hn::Mul(p.z, hn::Set(df, 1 / PackedDepth::kUnit_m));
      const auto error = hn::Sub(hn::ConvertTo(df, reading), expected);
      const auto nearest_error = hn::Sub(hn::ConvertTo(df, nearest), expected);
      const auto is_point = hn::FirstN(df, end - i);
      const auto valid = hn::And(hn::RebindMask(df, hn::Gt(reading, zero)), is_point);
      const auto supports = hn::And(valid, hn::Le(hn::Abs(error), tolerance));
      const auto refutes = hn::And(hn::And(hn::RebindMask(df, hn::Gt(nearest, zero)), is_point),
                                   hn::Gt(nearest_error, tolerance));
      counts.support_n += count(supports);
      counts.refute_n += count(refutes);
      counts.hidden_n += count(hn::And(valid, hn::Lt(error, hn::Neg(tolerance))));
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

NormalEquations icp_equations(const PackedDepth& depth, const KernelPose& pose,
                              const SurfaceSpan& surface, const TurnCentre& about,
                              float tolerance_m) {
  const auto tolerance = hn::Set(df, tolerance_m);
  const auto one = hn::Set(df, 1.0F);
  const auto zero = hn::Zero(df);
  const auto lever = [&](VF p, int axis) {
    return hn::Mul(hn::Sub(p, hn::Set(df, about.centre_m[axis])), hn::Set(df, 1 / about.radius_m));
  };
  VF A[21], b[6];
  for (VF& sum : A) sum = zero;
  for (VF& sum : b) sum = zero;
  NormalEquations equations;
  for (std::size_t i = 0; i < surface.points.size; i += hn::Lanes(df)) {
    const Vector3 p = in_camera(pose, surface.points, i);
    const auto inverse_z = hn::Div(one, p.z);
    const auto reading = low_half(packed_at(depth, cells_of(depth, p, inverse_z)));
    const auto error_m =
        hn::Sub(hn::Mul(hn::ConvertTo(df, reading), hn::Set(df, PackedDepth::kUnit_m)), p.z);
    const auto is_there = hn::RebindMask(df, hn::Gt(reading, hn::Zero(di)));
    const auto valid = hn::And(hn::And(is_there, hn::FirstN(df, surface.points.size - i)),
                               hn::Le(hn::Abs(error_m), tolerance));
    equations.points_n += static_cast<std::int32_t>(hn::CountTrue(df, valid));

    const Vector3 n = rotate(pose, load(surface.nx, surface.ny, surface.nz, i));
    const auto along = hn::MulAdd(n.x, p.x, hn::MulAdd(n.y, p.y, hn::Mul(n.z, p.z)));
    const auto distance_m = hn::Mul(along, hn::Mul(error_m, inverse_z));  // reading to plane
    const auto relative = hn::Mul(distance_m, hn::Set(df, 1 / tolerance_m));
    const auto root = hn::Max(zero, hn::NegMulAdd(relative, relative, one));
    const auto weight = hn::IfThenElseZero(valid, hn::Mul(root, root));
    const auto x = lever(p.x, 0);
    const auto y = lever(p.y, 1);
    const auto z = lever(p.z, 2);
    const VF J[6] = {hn::MulSub(y, n.z, hn::Mul(z, n.y)),
                     hn::MulSub(z, n.x, hn::Mul(x, n.z)),
                     hn::MulSub(x, n.y, hn::Mul(y, n.x)),
                     n.x,
                     n.y,
                     n.z};
    for (int row = 0, k = 0; row < 6; ++row) {
      const auto weighted = hn::Mul(weight, J[row]);
      for (int column = row; column < 6; ++column, ++k) {
        A[k] = hn::MulAdd(weighted, J[column], A[k]);
      }
      b[row] = hn::MulAdd(weighted, distance_m, b[row]);
    }
  }
  for (int k = 0; k < 21; ++k) equations.A[k] = hn::GetLane(hn::SumOfLanes(df, A[k]));
  for (int k = 0; k < 6; ++k) equations.b[k] = hn::GetLane(hn::SumOfLanes(df, b[k]));
  return equations;
}

void project_points(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                    std::int32_t* cells, float* z_m) {
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(df)) {
    const Vector3 p = in_camera(pose, points, i);
    hn::StoreU(cells_of(depth, p, hn::Div(hn::Set(df, 1.0F), p.z)), di, cells + i);
    hn::StoreU(p.z, df, z_m + i);
  }
}

float weigh_support(const PackedDepth& depth, const float* normals, const KernelPose& pose,
                    const SurfaceSpan& surface, const SupportWeights& weights) {
  const auto zero = hn::Zero(df);
  const auto one = hn::Set(df, 1.0F);
  const auto half = hn::Set(df, 0.5F);
  const auto scale = hn::Set(df, 1 / weights.tolerance_m);
  const auto cosines = hn::Set(df, 1 / (weights.agreeing_cosine - weights.opposing_cosine));
  auto support = zero;
  for (std::size_t i = 0; i < surface.points.size; i += hn::Lanes(df)) {
    const Vector3 p = in_camera(pose, surface.points, i);
    const auto cells = cells_of(depth, p, hn::Div(one, p.z));
    const auto reading = low_half(packed_at(depth, cells));
    const auto error_m =
        hn::Sub(hn::Mul(hn::ConvertTo(df, reading), hn::Set(df, PackedDepth::kUnit_m)), p.z);
    const auto error = hn::Mul(error_m, scale);
    const auto is_there = hn::RebindMask(df, hn::Gt(reading, hn::Zero(di)));
    const auto valid = hn::And(hn::And(is_there, hn::FirstN(df, surface.points.size - i)),
                               hn::Le(hn::Abs(error), one));

    const auto first = hn::Mul(cells, hn::Set(di, 3));
    const Vector3 seen{hn::GatherIndex(df, normals, first), hn::GatherIndex(df, normals + 1, first),
                       hn::GatherIndex(df, normals + 2, first)};
    const Vector3 n = rotate(pose, load(surface.nx, surface.ny, surface.nz, i));
    const auto dot = [](const Vector3& a, const Vector3& b) {
      return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
    };
    const auto agreement = hn::Clamp(
        hn::Mul(hn::Sub(dot(seen, n), hn::Set(df, weights.opposing_cosine)), cosines), zero, one);
    const auto is_flat = hn::Gt(dot(seen, seen), zero);  // else there is no normal to disagree
    const auto disagreement = hn::IfThenElseZero(is_flat, hn::Sub(one, agreement));
    const auto error2 = hn::Mul(error, error);
    const auto small = hn::Max(zero, hn::NegMulAdd(hn::Set(df, weights.small_error2), error2, one));
    const auto closeness = hn::Mul(half, hn::Add(hn::Sub(one, error2), small));
    const auto weight = hn::NegMulAdd(hn::Set(df, weights.normal), disagreement, one);
    support = hn::Add(support, hn::IfThenElseZero(valid, hn::Mul(closeness, weight)));
  }
  return hn::GetLane(hn::SumOfLanes(df, support));
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
HWY_EXPORT(icp_equations);
NormalEquations icp_equations(const PackedDepth& depth, const KernelPose& pose,
                              const SurfaceSpan& surface, const TurnCentre& about,
                              float tolerance_m) {
  return HWY_DYNAMIC_DISPATCH(icp_equations)(depth, pose, surface, about, tolerance_m);
}
HWY_EXPORT(project_points);
void project_points(const PackedDepth& depth, const KernelPose& pose, const PointSpan& points,
                    std::int32_t* cells, float* z_m) {
  HWY_DYNAMIC_DISPATCH(project_points)(depth, pose, points, cells, z_m);
}
HWY_EXPORT(weigh_support);
float weigh_support(const PackedDepth& depth, const float* normals, const KernelPose& pose,
                    const SurfaceSpan& surface, const SupportWeights& weights) {
  return HWY_DYNAMIC_DISPATCH(weigh_support)(depth, normals, pose, surface, weights);
}
}  // namespace graspd::perception
#endif
