#pragma once

#include <array>
#include <vector>

#include "graspd/agent/ports.hpp"

/// Stirring: where parts lie so that none can be grasped, a slow stroke of the closed gripper
/// through the top of the pile makes others of them accessible. A stroke stays inside the bin and
/// above its floor; the parts it touches are meant to be touched.
namespace graspd::agent {

/// How deep, how far, how fast and how often.
struct StirOptions {
  /// Without a part placed in between; then the cycle stops. There are four ways to stir.
  int max_in_a_row_n = 8;
  double depth_m = 0.015;    ///< of the finger tips below the top of the pile
  double stroke_m = 0.1;     ///< shorter where the bin is
  double speed_share = 0.2;  ///< of the arm's own speed, in the pile
};

/// Above, down, across, up.
using Stroke = std::array<Motion, 4>;

/// Strokes through the highest place of the readings in the bin: along its x and its y side, each
/// both ways. First those that come down beside what lies there.
/// \returns none where there is no bin, no reading in it, or no room in it for the gripper.
std::vector<Stroke> strokes(const Surroundings& surroundings, const graspd::Gripper& gripper,
                            const StirOptions& options);

}  // namespace graspd::agent
