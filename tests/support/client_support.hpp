#pragma once

#include <string>
#include <vector>

#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

/// The smallest frame and request that are valid.
namespace graspd {

inline DepthFrame example_frame(int width_px = 16, int height_px = 12) {
  DepthFrame frame;
  frame.camera = {width_px, height_px, 20, 20, width_px / 2.0, height_px / 2.0, {}};
  frame.depth.assign(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), 700);
  frame.depth[0] = 0;
  return frame;
}

inline PlanRequest example_request(const std::vector<std::string>& parts = {"echo"}) {
  PlanRequest request;
  for (const std::string& part : parts) request.parts.push_back({part, 0});
  return request;
}

}  // namespace graspd
