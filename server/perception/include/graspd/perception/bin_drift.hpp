#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "graspd/perception/parameters.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// How far a bin lies from where the request says, in the frame that the request gives it.
struct BinDrift {
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  double turn_rad = 0;  ///< about its z axis
  double corner_m = 0;  ///< of the rim's corner that is off most
};

/// Looks for the inner walls within 50 mm of where they should be, in lines of readings across
/// each: the shift and turn that most readings at walls agree on. Parts that lean on a wall agree
/// with nothing. What the sensor sees of walls is bent by `wall_bow_m`.
/// \returns nothing where too little of the walls is seen to say: a bin filled to the rim, or none.
std::optional<BinDrift> find_bin_drift(const DepthFrame& frame,
                                       const Eigen::Isometry3d& T_camera_bin,
                                       const Eigen::Vector3d& inner_size_m,
                                       const PreprocessParameters& parameters);

/// "the bin lies 12.0 mm along its x axis, −0.3 mm along y and 1.5° …"
std::string sentence_of(const BinDrift& drift);

}  // namespace graspd::perception
