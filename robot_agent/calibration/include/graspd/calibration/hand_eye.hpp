#pragma once

#include <span>

#include "graspd/calibration/board.hpp"

/// Where an overhead camera stands: from images of a board on the arm's flange, and the flange's
/// poses. SHAH's closed form (OpenCV's default, Tsai's, is singular for a camera that looks
/// straight down, turned by 180°), then a refinement that weighs the corners by the noise of image
/// and arm.
namespace graspd::calibration {

/// One image, and where the arm said its flange was.
struct FlangeView {
  std::string name;
  Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();
  BoardView board;
};

/// What is known of image and arm, and what is refused.
struct HandEyeOptions {
  std::size_t min_views_n = 8;
  double corner_sigma_px = 0.2;
  double flange_sigma_m = 0.0005;  ///< the arm's repeatability
  double flange_sigma_rad = 0.003;
  double min_tilt_rad = 0.1;        ///< standard deviation about the second of the axes
  double max_square_error = 0.015;  ///< share by which the board's squares may be mismeasured
};

/// By how much one view's board is elsewhere than a fit to the other views says.
struct ViewError {
  std::string name;
  double position_m = 0;  ///< of the board's middle
  double rotation_rad = 0;
};

/// Where camera and board stand, and how sure that is.
struct HandEye {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_flange_board = Eigen::Isometry3d::Identity();
  double reprojection_rms_px = 0;
  double square_m = 0;              ///< that fits the flange's motions best
  std::vector<ViewError> held_out;  ///< each view from a fit without its fold, worst first
  double position_rms_m = 0;        ///< of the held out views
  double rotation_rms_rad = 0;
};

/// \returns INVALID_ARGUMENT for too few views, views that are turned about one axis only, and a
/// board whose squares are of another size than the flange's motions say.
Result<HandEye> calibrate_hand_eye(std::span<const FlangeView> views, const Board& board,
                                   const CameraIntrinsics& camera,
                                   const HandEyeOptions& options = {});

}  // namespace graspd::calibration
