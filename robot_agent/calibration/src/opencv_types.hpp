#pragma once

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "graspd/types/frame.hpp"

/// Our types as OpenCV's, and back.
namespace graspd::calibration {

inline cv::Matx33d matrix_of(const CameraIntrinsics& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

inline cv::Matx33d rotation_of(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

inline cv::Vec3d translation_of(const Eigen::Isometry3d& T) {
  return {T.translation().x(), T.translation().y(), T.translation().z()};
}

/// \param rotation 3 × 3, of doubles; made a rotation to the last bit.
inline Eigen::Isometry3d pose_of(const cv::Mat& rotation, const cv::Mat& translation) {
  Eigen::Matrix3d R;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = rotation.at<double>(i, j);
    T.translation()[i] = translation.at<double>(i);
  }
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return T;
}

}  // namespace graspd::calibration
