#pragma once

#include <Eigen/Geometry>

#include "graspd/types/frame.hpp"

namespace graspd::bench {

/// Pixels u_first ≤ u < u_end, v_first ≤ v < v_end.
struct PixelBox {
  int u_first = 0;
  int v_first = 0;
  int u_end = 0;
  int v_end = 0;
};

/// What a depth sensor does to a few parts on the flat floor of a bin.
struct SensorMeasures {
  double empty_share = 0;        ///< of the pixels within the rim: no reading
  double plane_noise_mm = 0;     ///< median σ about planes through 11 × 11 pixels of floor
  double noise_correlation = 0;  ///< of neighbours in a row, after those planes are taken off
  double floor_bend_mm = 0;      ///< rise of the floor 10 to 20 mm from the wall over its middle
  double edge_width_px = 0;      ///< median 10–90 % width of steps from the floor up to a part
  double edge_roughness_px = 0;  ///< σ by which such a step's place jumps from row to row
  double flying_share = 0;    ///< of the pixels on parts: over 8 mm from a neighbour on both sides
  double slope_on_parts = 0;  ///< mean |dz| in mm from pixel to pixel on parts, edges left out
};

/// \param within_rim the bin as seen, \param floor its floor, where that is flat.
SensorMeasures measure(const DepthFrame& frame, const PixelBox& within_rim, const PixelBox& floor);

}  // namespace graspd::bench
