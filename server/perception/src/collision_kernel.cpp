#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "graspd/parts/triangle_groups.hpp"
#include "graspd/perception/collision_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace graspd::perception::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kGroup = parts::TriangleGroups::kTriangles;
static_assert(kGroup == static_cast<std::size_t>(FreeDepth::kTile));

using DF = hn::CappedTag<float, kGroup>;
using VF = hn::Vec<DF>;
using MF = hn::Mask<DF>;
constexpr DF df;

struct Vector3 {
  VF x, y, z;
};

HWY_INLINE VF set(float value) { return hn::Set(df, value); }
HWY_INLINE Vector3 minus(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE Vector3 transformed(const KernelPose& T, VF x, VF y, VF z) {
  const auto row = [&](int i) {
    return hn::MulAdd(
        set(T.R[3 * i]), x,
        hn::MulAdd(set(T.R[3 * i + 1]), y, hn::MulAdd(set(T.R[3 * i + 2]), z, set(T.t_m[i]))));
  };
  return {row(0), row(1), row(2)};
}

/// Along one axis: the interval of the triangle from p to q beyond ±reach, without touching.
HWY_INLINE MF apart(VF p, VF q, VF reach) {
  return hn::Or(hn::Gt(hn::Min(p, q), reach), hn::Lt(hn::Max(p, q), hn::Neg(reach)));
}

/// The axis across a box's edge and `edge` of the triangle. Of the edge's plane: its coordinates
/// (a, b), a corner of the edge and the corner opposite.
HWY_INLINE MF apart_across(VF edge_a, VF edge_b, VF on_a, VF on_b, VF opposite_a, VF opposite_b,
                           VF half_a, VF half_b) {
  const auto p = hn::MulSub(edge_a, on_b, hn::Mul(edge_b, on_a));
  const auto q = hn::MulSub(edge_a, opposite_b, hn::Mul(edge_b, opposite_a));
  return apart(p, q, hn::MulAdd(half_a, hn::Abs(edge_b), hn::Mul(half_b, hn::Abs(edge_a))));
}

/// Of triangles in the box's frame: which have a separating axis.
HWY_INLINE MF separated(const Vector3 (&corners)[3], const Vector3& half) {
  const auto beyond = [](VF a, VF b, VF c, VF reach) {
    // Touching counts as apart: these axes are never of no length.
    return hn::Or(hn::Ge(hn::Min(a, hn::Min(b, c)), reach),
                  hn::Le(hn::Max(a, hn::Max(b, c)), hn::Neg(reach)));
  };
  const auto& [a, b, c] = corners;
  MF result = hn::Or(beyond(a.x, b.x, c.x, half.x),
                     hn::Or(beyond(a.y, b.y, c.y, half.y), beyond(a.z, b.z, c.z, half.z)));
  const Vector3 edges[3] = {minus(b, a), minus(c, b), minus(a, c)};
  for (int i = 0; i < 3; ++i) {
    const Vector3& edge = edges[i];
    const Vector3& on = corners[i];
    const Vector3& opposite = corners[(i + 2) % 3];
    result = hn::Or(
        result, apart_across(edge.y, edge.z, on.y, on.z, opposite.y, opposite.z, half.y, half.z));
    result = hn::Or(
        result, apart_across(edge.z, edge.x, on.z, on.x, opposite.z, opposite.x, half.z, half.x));
    result = hn::Or(
        result, apart_across(edge.x, edge.y, on.x, on.y, opposite.x, opposite.y, half.x, half.y));
  }
  const Vector3 n = {hn::MulSub(edges[0].y, edges[1].z, hn::Mul(edges[0].z, edges[1].y)),
                     hn::MulSub(edges[0].z, edges[1].x, hn::Mul(edges[0].x, edges[1].z)),
                     hn::MulSub(edges[0].x, edges[1].y, hn::Mul(edges[0].y, edges[1].x))};
  const auto height = hn::MulAdd(n.x, a.x, hn::MulAdd(n.y, a.y, hn::Mul(n.z, a.z)));
  const auto reach = hn::MulAdd(hn::Abs(n.x), half.x,
                                hn::MulAdd(hn::Abs(n.y), half.y, hn::Mul(hn::Abs(n.z), half.z)));
  return hn::Or(result, hn::Gt(hn::Abs(height), reach));
}

bool meets_group(const float* corners_m, const Vector3& half, const KernelPose& T_box_part) {
  for (std::size_t i = 0; i < kGroup; i += hn::Lanes(df)) {
    Vector3 corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const float* from = corners_m + 3 * kGroup * k + i;
      corners[k] = transformed(T_box_part, hn::LoadU(df, from), hn::LoadU(df, from + kGroup),
                               hn::LoadU(df, from + 2 * kGroup));
    }
    if (!hn::AllTrue(df, separated(corners, half))) return true;
  }
  return false;
}

bool meets_surface(const KernelBox& box, const KernelPose& T_box_part,
                   const TriangleSpan& triangles) {
  const Vector3 half = {set(box.half_m[0]), set(box.half_m[1]), set(box.half_m[2])};
  const auto beyond = [](VF p, VF half_size) {
    return hn::Max(hn::Sub(hn::Abs(p), half_size), hn::Zero(df));
  };
  for (std::size_t i = 0; i < triangles.groups_n; i += hn::Lanes(df)) {
    const Vector3 p =
        transformed(T_box_part, hn::LoadU(df, triangles.x_m + i), hn::LoadU(df, triangles.y_m + i),
                    hn::LoadU(df, triangles.z_m + i));
    const auto radius = hn::LoadU(df, triangles.radius_m + i);
    const auto x = beyond(p.x, half.x);
    const auto y = beyond(p.y, half.y);
    const auto z = beyond(p.z, half.z);
    const auto distance2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    std::uint64_t near = 0;
    hn::StoreMaskBits(df, hn::Le(distance2, hn::Mul(radius, radius)),
                      reinterpret_cast<std::uint8_t*>(&near));
    for (; near != 0; near &= near - 1) {
      const std::size_t group = i + static_cast<std::size_t>(__builtin_ctzll(near));
      const float* corners_m = triangles.corners_m + parts::TriangleGroups::kFloats * group;
      if (meets_group(corners_m, half, T_box_part)) return true;
    }
  }
  return false;
}

/// Where a line enters and leaves the box.
struct Interval {
  VF near, far;
};
HWY_INLINE Interval slab(VF direction, float origin, float half) {
  const auto inverse = hn::Div(set(1), direction);
  const auto a = hn::Mul(set(-half - origin), inverse);
  const auto b = hn::Mul(set(half - origin), inverse);
  return {hn::Min(a, b), hn::Max(a, b)};
}

bool meets_unseen(const FreeDepth& image, const KernelBox& box, const KernelPose& T_box_camera,
                  const TileBox& tiles, float deepest_m, float tolerance_m) {
  constexpr int kTile = FreeDepth::kTile;
  const float* R = T_box_camera.R;
  const int tiles_per_row = image.width_px / kTile;
  const auto tolerance = set(tolerance_m);
  const auto inverse_fx = set(1 / image.fx_px);
  const float inverse_fy = 1 / image.fy_px;
  for (int tile_v = tiles.v_first; tile_v < tiles.v_last; ++tile_v) {
    for (int tile_u = tiles.u_first; tile_u < tiles.u_last; ++tile_u) {
      // Most of a gripper is above all that is seen there.
      const float free_m = image.tile_free_m[tile_v * tiles_per_row + tile_u];
      if (deepest_m <= free_m + tolerance_m) continue;
      for (int v = tile_v * kTile; v < (tile_v + 1) * kTile; ++v) {
        const float y = (static_cast<float>(v) - image.cy_px) * inverse_fy;
        for (int i = 0; i < kTile; i += static_cast<int>(hn::Lanes(df))) {
          const int u = tile_u * kTile + i;
          const auto x = hn::Mul(hn::Iota(df, static_cast<float>(u) - image.cx_px), inverse_fx);
          const auto direction = [&](int axis) {
            return hn::MulAdd(set(R[3 * axis]), x, set(R[3 * axis + 1] * y + R[3 * axis + 2]));
          };
          const Interval a = slab(direction(0), T_box_camera.t_m[0], box.half_m[0]);
          const Interval b = slab(direction(1), T_box_camera.t_m[1], box.half_m[1]);
          const Interval c = slab(direction(2), T_box_camera.t_m[2], box.half_m[2]);
          const auto free =
              hn::Add(hn::LoadU(df, image.free_m + v * image.width_px + u), tolerance);
          const auto near = hn::Max(hn::Max(a.near, b.near), hn::Max(c.near, free));
          const auto far = hn::Min(hn::Min(a.far, b.far), c.far);
          if (!hn::AllFalse(df, hn::Lt(near, far))) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace graspd::perception::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graspd::perception {
HWY_EXPORT(meets_surface);
bool meets_surface(const KernelBox& box, const KernelPose& T_box_part,
                   const TriangleSpan& triangles) {
  return HWY_DYNAMIC_DISPATCH(meets_surface)(box, T_box_part, triangles);
}
HWY_EXPORT(meets_unseen);
bool meets_unseen(const FreeDepth& image, const KernelBox& box, const KernelPose& T_box_camera,
                  const TileBox& tiles, float deepest_m, float tolerance_m) {
  return HWY_DYNAMIC_DISPATCH(meets_unseen)(image, box, T_box_camera, tiles, deepest_m,
                                            tolerance_m);
}
}  // namespace graspd::perception
#endif
