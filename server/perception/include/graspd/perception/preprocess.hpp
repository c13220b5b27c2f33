#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/floor.hpp"
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
/// twice as high above the floor that is seen are kept.
Scene preprocess(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                 const PreprocessParameters& parameters);

}  // namespace graspd::perception
