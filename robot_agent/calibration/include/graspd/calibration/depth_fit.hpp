#pragma once

#include <span>

#include "graspd/calibration/board.hpp"
#include "graspd/formats/depth_correction.hpp"

/// What a camera's depth is off by, from frames of a flat board whose pose the infrared image of
/// the same moment tells.
namespace graspd::calibration {

/// A frame that shows the board, and where the board truly is.
struct DepthView {
  std::string name;
  DepthFrame depth;
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
};

/// Readings against the board's plane.
struct DepthError {
  double mean_m = 0;  ///< positive: the camera reads too near
  double rms_m = 0;   ///< noise included
};

/// A correction, and how much better it makes frames that it was not fitted to.
struct DepthFit {
  DepthCorrection correction;
  DepthError before;
  DepthError held_out;       ///< each view corrected by a fit to the others
  double bias_before_m = 0;  ///< RMS over cells of 8 × 8 pixels, which average the noise
  double bias_held_out_m = 0;
  std::size_t readings_n = 0;
  double image_share = 0;  ///< seen by any view; elsewhere the correction is extrapolated
};

/// \param board where it has a plain margin only that is read: what a time-of-flight camera reads
/// depends on how much a surface reflects.
/// \returns INVALID_ARGUMENT for fewer than three views, a view of another size than the camera's,
/// or one that hardly reads the board.
Result<DepthFit> fit_depth_correction(std::span<const DepthView> views, const Board& board,
                                      const CameraIntrinsics& camera);

}  // namespace graspd::calibration
