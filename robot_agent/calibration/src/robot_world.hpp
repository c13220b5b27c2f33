#pragma once

#include "graspd/calibration/hand_eye.hpp"

namespace graspd::calibration {

/// Both unknowns of T_camera_board = T_base_camera⁻¹ · T_base_flange · T_flange_board.
struct RobotWorld {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_flange_board = Eigen::Isometry3d::Identity();
  double scale = 1;  ///< of the board's squares
};

using ViewRefs = std::vector<const FlangeView*>;

/// SHAH's closed form. Wants views turned about at least two axes.
RobotWorld solve_shah(const ViewRefs& views);

/// Least squares over the corners from there, by Levenberg and Marquardt. A view's residuals are
/// whitened by what corners and flange may be off, so that neither a near board nor the arm's play
/// has more say than it should.
RobotWorld refine(const ViewRefs& views, const CameraIntrinsics& camera,
                  const HandEyeOptions& options, const RobotWorld& start, bool with_scale);

/// \returns u, v, u, v, … of the view's corners where `solution` has them, less where they are
/// seen.
Eigen::VectorXd reprojection_px(const FlangeView& view, const CameraIntrinsics& camera,
                                const RobotWorld& solution);

}  // namespace graspd::calibration
