#pragma once

#include <span>

#include "graspd/types/frame.hpp"

namespace graspd {

inline constexpr std::size_t kMaxMeanFrames = 32;

/// One frame of several looks of one camera at a scene that stands still: noise that differs from
/// look to look goes down by the root of their number, what bends every look alike stays.
///
/// A pixel is the mean of its readings within 1 cm of their median: on edges readings jump between
/// front and back, and a mean of both would lie where nothing is. It has no reading where half of
/// the frames or more have none. The unit of the depth is a tenth of the frames', so that the mean
/// is not rounded to theirs; more where the deepest reading would not fit. The stamp is the first
/// frame's. One frame is returned as it is.
///
/// \param frames 1 to kMaxMeanFrames.
/// \returns INVALID_ARGUMENT where their number, or the cameras, units or sizes of two of them, do
/// not fit.
Result<DepthFrame> mean_frame(std::span<const DepthFrame> frames);

}  // namespace graspd
