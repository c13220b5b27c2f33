#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "graspd/perception/bowed_walls.hpp"
#include "graspd/perception/cloud.hpp"
#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/floor.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

/// From the readings of a frame to those that may be parts': what every preprocessing has in
/// common.
namespace graspd::perception {

/// The box that the passthrough filter keeps: z up, origin in the middle of its floor.
struct Workspace {
  Eigen::Isometry3d T_camera_workspace = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  double heap_m = 0;  ///< above it, of parts heaped up over a bin's rim

  /// What is kept, in the workspace's frame: below the floor, by noise or bowing, is still the
  /// floor.
  Eigen::AlignedBox3d kept_m() const;
};
/// The request's bin, without the margin at its walls, or its crop box. Nothing where it has
/// neither.
std::optional<Workspace> requested_workspace(const PlanRequest& request,
                                             const PreprocessParameters& parameters);

/// The points within `Workspace::kept_m`, in their order.
Cloud passthrough(const Cloud& cloud, const Workspace& workspace);

/// A frame, made ready for segmentation, registration and collision checks.
struct Scene {
  Cloud cloud;  ///< what lies on the floor, with normals
  /// z up, origin on the floor: the bin's frame, or made from the floor that was found; without
  /// any floor, z towards the camera and the origin at the deepest point.
  Eigen::Isometry3d T_camera_floor = Eigen::Isometry3d::Identity();
  bool has_floor = false;  ///< a bin's, or found: nothing can lie below it
  Funnel funnel;           ///< up to after_plane_n
  std::optional<double> fill_level;
  std::vector<std::string> warnings;
  std::optional<DepthGrid> grid;  ///< of an organised cloud: the image that it was taken from
  /// Where parts may lie, in the floor's frame.
  Eigen::AlignedBox3d workspace_m;
  /// All that is seen where parts may lie, floor and walls among it: readings only, nothing else of
  /// the grid is set.
  std::optional<DepthGrid> seen;
  /// Of a bin: where grid and `seen` may still be bowed.
  std::optional<BowedWalls> walls;
};

/// In what the preprocessings differ.
struct Sampling {
  std::function<Cloud(Cloud)> thin;  ///< the readings in the workspace
  decltype(&find_floor) find_plane;
};

/// Passthrough filter and plane removal. The scene's cloud has no normals yet.
/// \param part_diameter_m of the largest requested part: without bin and crop box, the points up to
/// twice as high above the floor that is seen are kept.
Scene cut_out_parts(const DepthFrame& frame, const Cloud& readings, const PlanRequest& request,
                    double part_diameter_m, const PreprocessParameters& parameters,
                    const Sampling& sampling);

}  // namespace graspd::perception
