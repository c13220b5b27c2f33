#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "cell_config.hpp"
#include "graspd/formats/depth_correction.hpp"

namespace graspd::robot_agent {

/// Where camera and bin stand, and what the camera is, from all who can say it.
struct CellFrames {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  std::optional<CameraIntrinsics> intrinsics;  ///< nothing: the recording says them
  std::optional<DepthCorrection> depth_correction;
  std::optional<Bin> bin;
};

/// The configuration counts before the calibration file, and that before the recorded scene. A
/// camera of which nobody says where it stands is the base itself, and looks straight down
/// (`looking_down`), where no arm moves.
/// \returns INVALID_ARGUMENT where a file that is named can't be read, or does not say where the
/// camera of an arm that moves stands.
Result<CellFrames> find_cell_frames(const CellConfig& config);

}  // namespace graspd::robot_agent
