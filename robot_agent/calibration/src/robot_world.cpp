#include "robot_world.hpp"

#include <Eigen/Cholesky>
#include <unsupported/Eigen/NonLinearOptimization>

#include "graspd/types/camera_model.hpp"
#include "opencv_types.hpp"

namespace graspd::calibration {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A small motion: rotation vector, then translation.
Eigen::Isometry3d motion_of(const Eigen::Ref<const Vector6d>& twist) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const double angle_rad = twist.head<3>().norm();
  if (angle_rad > 0) {
    T.linear() = Eigen::AngleAxisd(angle_rad, twist.head<3>() / angle_rad).toRotationMatrix();
  }
  T.translation() = twist.tail<3>();
  return T;
}

Eigen::VectorXd reprojection_of(const FlangeView& view, const CameraIntrinsics& camera,
                                const RobotWorld& solution, const Eigen::Isometry3d& play) {
  const Eigen::Isometry3d T_camera_board =
      solution.T_base_camera.inverse() * view.T_base_flange * play * solution.T_flange_board;
  Eigen::VectorXd off_px(2 * static_cast<Eigen::Index>(view.board.p_px.size()));
  for (std::size_t i = 0; i < view.board.p_px.size(); ++i) {
    const Eigen::Vector3d p = T_camera_board * (solution.scale * view.board.p_board_m[i]);
    off_px.segment<2>(2 * static_cast<Eigen::Index>(i)) = project(camera, p) - view.board.p_px[i];
  }
  return off_px;
}

/// The lower triangle L of C = L·Lᵀ, the covariance of a view's residuals: the corners' own noise,
/// and the flange's play, which moves them all together.
Eigen::LLT<Eigen::MatrixXd> covariance_of(const FlangeView& view, const CameraIntrinsics& camera,
                                          const HandEyeOptions& options,
                                          const RobotWorld& solution) {
  constexpr double kStep = 1e-6;
  const Eigen::Index n = 2 * static_cast<Eigen::Index>(view.board.p_px.size());
  Eigen::MatrixXd C =
      Eigen::MatrixXd::Identity(n, n) * options.corner_sigma_px * options.corner_sigma_px;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Vector6d step = Vector6d::Unit(i) * kStep;
    const Eigen::VectorXd column = (reprojection_of(view, camera, solution, motion_of(step)) -
                                    reprojection_of(view, camera, solution, motion_of(-step))) /
                                   (2 * kStep) *
                                   (i < 3 ? options.flange_sigma_rad : options.flange_sigma_m);
    C += column * column.transpose();
  }
  return C.llt();
}

/// The whitened residuals as a function of small motions of both unknowns, and of the scale.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const ViewRefs& views;
  const CameraIntrinsics& camera;
  RobotWorld start;
  int inputs_n;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> covariances;

  int inputs() const { return inputs_n; }
  int values() const {
    Eigen::Index n = 0;
    for (const auto& covariance : covariances) n += covariance.rows();
    return static_cast<int>(n);
  }
  RobotWorld at(const Eigen::VectorXd& x) const {
    return {start.T_base_camera * motion_of(x.head<6>()),
            start.T_flange_board * motion_of(x.segment<6>(6)),
            inputs_n > 12 ? start.scale * (1 + x[12]) : start.scale};
  }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& values) const {
    const RobotWorld solution = at(x);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Eigen::VectorXd white =
          covariances[i].matrixL().solve(reprojection_px(*views[i], camera, solution));
      values.segment(row, white.size()) = white;
      row += white.size();
    }
    return 0;
  }
};

}  // namespace

RobotWorld solve_shah(const ViewRefs& views) {
  std::vector<cv::Mat> R_camera_board;
  std::vector<cv::Mat> t_camera_board;
  std::vector<cv::Mat> R_base_flange;
  std::vector<cv::Mat> t_base_flange;
  for (const FlangeView* view : views) {
    R_camera_board.emplace_back(rotation_of(view->board.T_camera_board));
    t_camera_board.emplace_back(translation_of(view->board.T_camera_board));
    R_base_flange.emplace_back(rotation_of(view->T_base_flange));
    t_base_flange.emplace_back(translation_of(view->T_base_flange));
  }
  // OpenCV has the camera on the hand and the board in the world. Here the board is on the hand:
  // T_camera_board · T_board_flange = T_camera_base · T_base_flange is the same equation.
  cv::Mat R_board_flange;
  cv::Mat t_board_flange;
  cv::Mat R_camera_base;
  cv::Mat t_camera_base;
  cv::calibrateRobotWorldHandEye(R_camera_board, t_camera_board, R_base_flange, t_base_flange,
                                 R_board_flange, t_board_flange, R_camera_base, t_camera_base,
                                 cv::CALIB_ROBOT_WORLD_HAND_EYE_SHAH);
  return {pose_of(R_camera_base, t_camera_base).inverse(),
          pose_of(R_board_flange, t_board_flange).inverse(), 1};
}

RobotWorld refine(const ViewRefs& views, const CameraIntrinsics& camera,
                  const HandEyeOptions& options, const RobotWorld& start, bool with_scale) {
  Residuals residuals{views, camera, start, with_scale ? 13 : 12, {}};
  for (const FlangeView* view : views) {
    residuals.covariances.push_back(covariance_of(*view, camera, options, start));
  }
  Eigen::NumericalDiff<Residuals, Eigen::Central> differentiable(residuals);
  Eigen::LevenbergMarquardt solver(differentiable);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(residuals.inputs());
  solver.minimize(x);
  return residuals.at(x);
}

Eigen::VectorXd reprojection_px(const FlangeView& view, const CameraIntrinsics& camera,
                                const RobotWorld& solution) {
  return reprojection_of(view, camera, solution, Eigen::Isometry3d::Identity());
}

}  // namespace graspd::calibration
