#pragma once

#include <span>

#include "graspd/perception/parameters.hpp"
#include "graspd/perception/scene.hpp"

namespace graspd::perception {

/// The undistorted, sharpened and mended image of where parts may lie: the workspace's box, or the
/// whole frame where the request names none. Only its readings are set.
DepthGrid seen_in_workspace(const DepthFrame& frame, const PlanRequest& request,
                            const PreprocessParameters& parameters);

/// The organised path, ahead of the paper's: the cloud stays on the image grid, so that neighbours
/// are neighbouring cells, and nothing is searched for. Lens distortion is taken out, smoothed
/// edges are sharpened, workspace and floor are as in the paper's preprocessing, points that float
/// between two surfaces are dropped, and there is no voxel grid.
///
/// The scene's cloud is organised in the cells of the scene's grid.
Scene preprocess_organised(const DepthFrame& frame, const PlanRequest& request,
                           double part_diameter_m, const PreprocessParameters& parameters);

/// Its two halves: all that poses are compared with, and what only segments and hypotheses need:
/// normals, and the cells of the cloud.
Scene organised_readings(const DepthFrame& frame, const PlanRequest& request,
                         double part_diameter_m, const PreprocessParameters& parameters);
/// The second half: of a scene of `organised_readings`.
void add_normals(Scene& scene);

/// Takes the grid's islands that no segment has a point in for floor: too small for a part, with
/// nothing around them that could hide the rest. Noise and a bowed floor leave such.
void drop_islands_without_segments(std::span<const Indices> segments, Scene& scene);

}  // namespace graspd::perception
