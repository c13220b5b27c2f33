#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// The paper's preprocessing: depth image → cloud → passthrough filter → voxel grid → RANSAC plane.
namespace graspd::perception {

/// One point per pixel whose reading lies in the depth range. Lens distortion is removed.
Cloud unproject(const DepthFrame& frame, const PreprocessParameters& parameters);

/// The box that the passthrough filter keeps: z up, origin in the middle of its floor.
struct Workspace {
  Eigen::Isometry3d T_camera_workspace = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};
/// The request's bin, without the margin at its walls, or its crop box. Nothing where it has
/// neither.
std::optional<Workspace> requested_workspace(const PlanRequest& request,
                                             const PreprocessParameters& parameters);

Cloud passthrough(const Cloud& cloud, const Workspace& workspace);

/// The centroid of the points in each cube of side `voxel_m`, in a fixed order.
Cloud voxel_grid(const Cloud& cloud, double voxel_m);

/// A plane whose normal points towards the camera: normal · p + offset_m is the height above it.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset_m = 0;

  float height_m(const Eigen::Vector3f& p_m) const { return normal.dot(p_m) + offset_m; }
};

/// The floor by RANSAC: the plane with most points, accepted where it has at least
/// `plane_min_share` of them and next to none lie behind it.
/// \param up_camera where given, the plane must be perpendicular to it within 15°.
std::optional<Plane> find_floor(const Cloud& cloud, const std::optional<Eigen::Vector3f>& up_camera,
                                const PreprocessParameters& parameters);

/// The points higher than `plane_tolerance_m` above the plane and not above `max_height_m`.
Cloud above_plane(const Cloud& cloud, const Plane& plane, double max_height_m,
                  const PreprocessParameters& parameters);

/// Fits a plane to the `normal_neighbours_n` nearest points of each point.
void estimate_normals(Cloud& cloud, const PreprocessParameters& parameters);

struct Scene {
  Cloud cloud;  ///< what lies on the floor, with normals
  /// z up, origin on the floor: the bin's frame, or made from the floor that was found; without
  /// any floor, z towards the camera and the origin at the deepest point.
  Eigen::Isometry3d T_camera_floor = Eigen::Isometry3d::Identity();
  bool has_floor = false;  ///< a bin's, or found: nothing can lie below it
  Funnel funnel;           ///< up to after_plane_n
  std::optional<double> fill_level;
  std::vector<std::string> warnings;
};

/// All of the above in the paper's order.
/// \param part_diameter_m of the largest requested part: without bin and crop box, the points up to
/// twice as high above the floor are kept.
Scene preprocess(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                 const PreprocessParameters& parameters);

}  // namespace graspd::perception
