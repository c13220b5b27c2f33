#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>

#include "graspd/calibration/board.hpp"
#include "graspd/types/frame.hpp"

/// What a camera sees of a calibration board: computed ray by ray from its true pose, so that of
/// what is tested only OpenCV's pattern is used to make it.
namespace graspd::testing {

/// A Kinect v2's.
inline const CameraIntrinsics kKinect{
    512, 424, 365.5, 365.5, 255, 205, {0.0905, -0.268, 0, 0, 0.095}};

struct BoardScene {
  calibration::Board board;
  CameraIntrinsics camera;
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
};

/// A pose of the board's middle, `distance_m` away, tilted about the camera's x and y and turned
/// about its z.
Eigen::Isometry3d facing(const calibration::Board& board, const Eigen::Vector2d& aside_m,
                         double distance_m, const Eigen::Vector3d& turn_rad);

/// The infrared image: blurred by the pixel's own size, with noise of `noise` grey levels.
calibration::GrayImage see_board(const BoardScene& scene, double noise, std::uint64_t seed);

/// Millimetres to the plate alone. \param off_m what the camera adds at a pixel's ray and depth.
DepthFrame read_plate(const BoardScene& scene, double noise_m, std::uint64_t seed,
                      const std::function<double(const Eigen::Vector3d&, double)>& off_m);

}  // namespace graspd::testing
