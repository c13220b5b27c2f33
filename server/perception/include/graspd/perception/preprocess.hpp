#pragma once

#include "graspd/perception/cloud.hpp"
#include "graspd/perception/floor.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/scene.hpp"

/// The paper's preprocessing: depth image → cloud → passthrough filter → voxel grid → RANSAC plane.
namespace graspd::perception {

/// One point per pixel whose reading lies in the depth range. Lens distortion is removed.
Cloud unproject(const DepthFrame& frame, const PreprocessParameters& parameters);

/// The centroid of the points in each cube of side `voxel_m`, in a fixed order.
Cloud voxel_grid(const Cloud& cloud, double voxel_m);

/// Fits a plane to the `normal_neighbours_n` nearest points of each point.
void estimate_normals(Cloud& cloud, const PreprocessParameters& parameters);

/// All of the above in the paper's order.
Scene preprocess(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                 const PreprocessParameters& parameters);

/// The preprocessing that goes with the segmentation method: the organised one with grid_dbscan,
/// else the paper's.
Scene prepare_scene(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                    const Parameters& parameters);

/// The same, but for the normals of a scene that has a grid: see `add_normals`.
Scene prepare_readings(const DepthFrame& frame, const PlanRequest& request, double part_diameter_m,
                       const Parameters& parameters);

}  // namespace graspd::perception
