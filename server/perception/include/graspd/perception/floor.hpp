#pragma once

#include <Eigen/Core>
#include <optional>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/parameters.hpp"

namespace graspd::perception {

/// A plane whose normal points towards the camera: normal · p + offset_m is the height above it.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset_m = 0;

  /// Signed: above the plane, towards the camera, it is positive.
  float height_m(const Eigen::Vector3f& p_m) const { return normal.dot(p_m) + offset_m; }
};

/// The floor by RANSAC: the plane with most points, accepted where it has at least
/// `plane_min_share` of them and next to none lie behind it.
/// \param up_camera where given, the plane must be perpendicular to it within 15°.
std::optional<Plane> find_floor(const Cloud& cloud, const std::optional<Eigen::Vector3f>& up_camera,
                                const PreprocessParameters& parameters);

/// The same from a sample of the points, and so in a fraction of the time. Refined with robust
/// weights, since a floor may be bowed, and then RANSAC's planes are tilted now so, now otherwise.
std::optional<Plane> fit_floor(const Cloud& cloud, const std::optional<Eigen::Vector3f>& up_camera,
                               const PreprocessParameters& parameters);

/// The points higher than `plane_tolerance_m` above the plane and not above `max_height_m`.
Cloud above_plane(const Cloud& cloud, const Plane& plane, double max_height_m,
                  const PreprocessParameters& parameters);

/// The points over the floor that is seen, less `wall_margin_m` at its edge: walls and what lies
/// outside of a bin are not. The floor is the hull of the plane's largest connected part in `all`;
/// what is no higher than a part connects: a pile divides the floor, a wall ends it.
Cloud over_floor(const Cloud& cloud, const Cloud& all, const Plane& floor, double part_diameter_m,
                 const PreprocessParameters& parameters);

}  // namespace graspd::perception
