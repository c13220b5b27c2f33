#pragma once

#include <mrpt/obs/CObservation3DRangeScan.h>

#include <string>

#include "graspd/types/frame.hpp"

/// DepthFrame <-> mrpt::obs::CObservation3DRangeScan.
namespace graspd {

mrpt::obs::CObservation3DRangeScan to_observation(const DepthFrame& frame);

/// \returns INVALID_ARGUMENT where the observation holds no depth image, or one that DepthFrame
/// can't say: ranges along the rays, a fisheye model, an image stored outside the rawlog.
Result<DepthFrame> to_frame(const mrpt::obs::CObservation3DRangeScan& observation);

}  // namespace graspd
