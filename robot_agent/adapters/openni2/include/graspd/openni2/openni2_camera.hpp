#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "graspd/agent/ports.hpp"
#include "graspd/formats/depth_correction.hpp"

/// A depth camera through OpenNI2: a Kinect v2 with libfreenect2's OpenNI2 plug-in, which is not in
/// Debian and goes into OpenNI2's folder of drivers.
namespace graspd::openni2 {

/// Which device, in which mode, and what is known of its camera.
struct CameraOptions {
  std::string uri;  ///< empty: the first device
  /// Of the frames as this camera gives them, mirrored back. Never the driver's own: the field of
  /// view it reports is the Kinect v1's. Its size is the mode that is asked for.
  CameraIntrinsics camera;
  int frames_per_second = 30;
  bool is_mirrored = true;  ///< the driver swaps left and right: swapped back
  std::optional<DepthCorrection> depth_correction;
  std::chrono::milliseconds timeout{2000};  ///< without a frame
};

/// Of the frames that arrive after `next` was called the second is given: the first may still show
/// the arm that has just left.
///
/// A frame is stamped by when it arrived, less one frame's time: its exposure did not begin later.
/// How much earlier is not known, since no driver tells how long a frame takes through USB and its
/// depth computation. OpenNI2's own timestamps are no help: libfreenect2's plug-in counts the
/// frames it delivers and takes each for 33.369 ms, so that they fall behind with each lost frame.
///
/// \param clock must outlive the camera.
/// \returns UNAVAILABLE where there is no device, or none that has this mode.
Result<std::unique_ptr<agent::Camera>> open_camera(const CameraOptions& options,
                                                   agent::Clock& clock);

}  // namespace graspd::openni2
