#pragma once

#include <filesystem>
#include <optional>

#include "graspd/formats/depth_correction.hpp"
#include "graspd/formats/yaml.hpp"
#include "graspd/types/request.hpp"

/// Files that describe a cell: its camera's calibration, its bin, its gripper.
namespace graspd {

/// What is known of a camera beside its frames.
struct CameraCalibration {
  CameraIntrinsics camera;
  double depth_scale_m = 0.001;
  std::optional<Eigen::Isometry3d> T_base_camera;
  std::optional<DepthCorrection> depth_correction;
};

/// Reads an OpenCV calibration file (image_width, image_height, camera_matrix,
/// distortion_coefficients), with our optional keys depth_scale_m, T_base_camera (16 numbers row by
/// row, metres) and depth_correction (the members of DepthCorrection).
Result<CameraCalibration> read_camera(const std::filesystem::path& path);
/// What `read_camera` reads again.
Result<void> write_camera(const std::filesystem::path& path, const CameraCalibration& calibration);

/// The camera's pose in a base whose origin is at the camera and whose z points up (−z of the
/// optical frame), for a camera that looks straight down: where nobody says another, and nothing
/// moves.
Eigen::Isometry3d looking_down();

/// The keys of a `bin:` section: T_base_bin, inner_size_m, wall_thickness_m.
Bin read_bin(YamlMap map);
/// The keys of a `gripper:` section, as the members of Gripper.
Gripper read_gripper(YamlMap map);

/// A cell file: `bin:` and `gripper:` sections, either of them optional.
struct Cell {
  std::optional<Bin> bin;
  Gripper gripper;
};
/// Other keys are faults. \returns INVALID_ARGUMENT with one line per fault.
Result<Cell> read_cell(const std::filesystem::path& path);

}  // namespace graspd
