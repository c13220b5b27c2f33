#include "flat_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "visit_surface.hpp"

namespace graspd::parts {
namespace {

constexpr double kCentres = 300;
constexpr double kMinRadius_m = 0.003;  // the smallest cups in use
constexpr double kMaxRadius_m = 0.025;
constexpr double kStep_m = 0.001;
constexpr int kRays = 12;  // of a ring
// What a lip follows: of its radius, and the steps of a tessellated curve.
constexpr double kMaxSag = 0.12;
constexpr double kMinSag_m = 0.0002;

/// Whether the surface about the centre, seen from outside, is flat along a ring.
bool seals_along(const TriangleTree& tree, const FlatPatch& patch, double radius_m) {
  const double sag_m = std::max(kMinSag_m, kMaxSag * radius_m);
  const Eigen::Vector3d u = patch.normal.unitOrthogonal();
  const Eigen::Vector3d v = patch.normal.cross(u);
  for (int k = 0; k < kRays; ++k) {
    const double angle_rad = 2 * std::numbers::pi * k / kRays;
    const Eigen::Vector3d on_ring_m =
        patch.centre_m + radius_m * (std::cos(angle_rad) * u + std::sin(angle_rad) * v);
    const auto hit = tree.first_hit(on_ring_m + kOutside_m * patch.normal, -patch.normal);
    if (!(std::abs(hit.distance_m - kOutside_m) <= sag_m)) return false;
  }
  return true;
}

}  // namespace

std::optional<FlatPatch> flat_patch_at(const TriangleTree& tree, const Eigen::Vector3d& centre_m,
                                       const Eigen::Vector3d& normal) {
  FlatPatch patch{centre_m, normal, 0};
  while (patch.radius_m < kMaxRadius_m && seals_along(tree, patch, patch.radius_m + kStep_m)) {
    patch.radius_m += kStep_m;
  }
  // Steps add up to a little less.
  return patch.radius_m > kMinRadius_m - kStep_m / 2 ? std::optional(patch) : std::nullopt;
}

std::vector<FlatPatch> flat_patches(const Mesh& mesh, const TriangleTree& tree) {
  std::vector<FlatPatch> patches;
  visit_surface(mesh, kCentres / surface_area_m2(mesh), [&](const SurfacePoint& point) {
    const auto patch = flat_patch_at(tree, point.position_m.cast<double>(),
                                     point.normal.cast<double>().normalized());
    if (patch) patches.push_back(*patch);
  });
  return patches;
}

}  // namespace graspd::parts
