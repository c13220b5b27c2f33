#pragma once

#include <filesystem>
#include <optional>

#include "graspd/calibration/board.hpp"

namespace graspd::calibration {

/// What of a moment was recorded; the arm's pose and the depth image where the calibration needs
/// them.
struct RecordedView {
  std::string name;  ///< of the image's file
  GrayImage image;
  std::optional<Eigen::Isometry3d> T_base_flange;
  std::optional<DepthFrame> depth;
};

/// What a calibration starts from: a folder with infrared images, depth images and `poses.yaml`:
///
///     board: {columns_n: 7, rows_n: 5, square_m: 0.04, marker_m: 0.03}   # members of Board
///     mirrored: true            # the images are as the Kinect delivers them; default false
///     views:
///       - image: ir_00.png
///         T_base_flange: [16 numbers, row by row, metres]   # for the hand-eye calibration
///         depth: depth_00.png                               # for the depth correction
///
/// What comes out of this is mirrored back.
struct Recording {
  Board board;
  CameraIntrinsics camera;  ///< of the views, mirrored back
  std::vector<RecordedView> views;
};

/// \param camera of the images as they are in the folder.
/// \returns INVALID_ARGUMENT with one line per fault of the file, or naming the image that can't be
/// read or has another size than the camera's.
Result<Recording> read_recording(const std::filesystem::path& folder,
                                 const CameraIntrinsics& camera, double depth_scale_m);

}  // namespace graspd::calibration
