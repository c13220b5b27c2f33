#pragma once

#include "block_scene.hpp"
#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/preprocess.hpp"

namespace graspd::testing {

/// The blocks on a floor square to the camera, as registration sees them: what lies 5 mm above the
/// floor may be a part.
inline perception::DepthGrid grid_of(const std::vector<Block>& blocks, double floor_m) {
  const perception::PreprocessParameters parameters;
  const DepthFrame frame = render(kinect_v2(), floor_m, blocks);
  perception::Cloud cloud = perception::unproject(frame, parameters);
  std::erase_if(cloud.points_m, [&](const auto& p) { return p.z() > floor_m - 0.005; });
  return perception::make_depth_grid(frame, cloud, parameters);
}

}  // namespace graspd::testing
