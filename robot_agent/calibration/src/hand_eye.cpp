#include "graspd/calibration/hand_eye.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "robot_world.hpp"

namespace graspd::calibration {
namespace {

constexpr std::size_t kFolds = 5;
constexpr double kRadToDeg = 180 / M_PI;

/// Spread of the flange's rotations about the second of their main axes. Both unknowns are only
/// seen by turns about two axes.
double second_tilt_rad(std::span<const FlangeView> views) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const FlangeView& view : views) sum += view.T_base_flange.linear();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d proper = Eigen::Matrix3d::Identity();
  proper(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Eigen::Matrix3d mean = svd.matrixU() * proper * svd.matrixV().transpose();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const FlangeView& view : views) {
    const Eigen::AngleAxisd turn(mean.transpose() * view.T_base_flange.linear());
    const Eigen::Vector3d turn_rad = turn.angle() * turn.axis();
    scatter += turn_rad * turn_rad.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[1]) / static_cast<double>(views.size()));
}

Result<void> check(std::span<const FlangeView> views, const HandEyeOptions& options) {
  if (views.size() < options.min_views_n) {
    return invalid(
        "{} views show the board with a flange pose, at least {} are needed; 15 to 30, tilted "
        "about two axes, are good",
        views.size(), options.min_views_n);
  }
  const double tilt_rad = second_tilt_rad(views);
  if (tilt_rad < options.min_tilt_rad) {
    return invalid(
        "the flange was turned about one axis only, or hardly at all: about the second axis by "
        "{:.1f}° on average, at least {:.1f}° are needed; tilt the board by 20° to 40° about two "
        "axes",
        tilt_rad * kRadToDeg, options.min_tilt_rad * kRadToDeg);
  }
  return {};
}

/// The views that no wrong pose makes stick out.
ViewRefs consistent(std::span<const FlangeView> views, const std::vector<ViewError>& worst_first) {
  const double limit_m = 3 * worst_first[worst_first.size() / 2].position_m;
  ViewRefs kept;
  for (const FlangeView& view : views) {
    const auto error = std::find_if(worst_first.begin(), worst_first.end(),
                                    [&](const ViewError& e) { return e.name == view.name; });
    if (error->position_m <= limit_m) kept.push_back(&view);
  }
  return kept;
}

Result<void> check_square(double square_m, const Board& board, const HandEyeOptions& options) {
  if (std::abs(square_m / board.square_m - 1) <= options.max_square_error) return {};
  return invalid(
      "the flange's motions fit squares of {:.2f} mm, but the board is said to have {:.2f} mm: "
      "measure them, and check that the flange poses are in metres",
      square_m * 1e3, board.square_m * 1e3);
}

RobotWorld fit(const ViewRefs& views, const CameraIntrinsics& camera,
               const HandEyeOptions& options) {
  return refine(views, camera, options, solve_shah(views), false);
}

ViewError error_of(const FlangeView& view, const Board& board, const RobotWorld& solution) {
  const Eigen::Isometry3d T_camera_board =
      solution.T_base_camera.inverse() * view.T_base_flange * solution.T_flange_board;
  const Eigen::Vector3d middle_m(board.size_m().x() / 2, board.size_m().y() / 2, 0);
  const Eigen::Isometry3d& seen = view.board.T_camera_board;
  return {view.name, (T_camera_board * middle_m - seen * middle_m).norm(),
          Eigen::AngleAxisd(T_camera_board.linear().transpose() * seen.linear()).angle()};
}

std::vector<ViewError> held_out_errors(std::span<const FlangeView> views, const Board& board,
                                       const CameraIntrinsics& camera,
                                       const HandEyeOptions& options) {
  std::vector<ViewError> errors;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    ViewRefs others;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (i % kFolds != fold) others.push_back(&views[i]);
    }
    const RobotWorld solution = fit(others, camera, options);
    for (std::size_t i = fold; i < views.size(); i += kFolds) {
      errors.push_back(error_of(views[i], board, solution));
    }
  }
  std::sort(errors.begin(), errors.end(),
            [](const ViewError& a, const ViewError& b) { return a.position_m > b.position_m; });
  return errors;
}

double rms(const std::vector<ViewError>& errors, double ViewError::*of) {
  double sum = 0;
  for (const ViewError& error : errors) sum += error.*of * error.*of;
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

double reprojection_rms(const ViewRefs& views, const CameraIntrinsics& camera,
                        const RobotWorld& solution) {
  double sum_px2 = 0;
  std::size_t corners_n = 0;
  for (const FlangeView* view : views) {
    sum_px2 += reprojection_px(*view, camera, solution).squaredNorm();
    corners_n += view->board.p_px.size();
  }
  return std::sqrt(sum_px2 / static_cast<double>(corners_n));
}

}  // namespace

Result<HandEye> calibrate_hand_eye(std::span<const FlangeView> views, const Board& board,
                                   const CameraIntrinsics& camera, const HandEyeOptions& options) {
  if (auto ok = check(views, options); !ok) return tl::unexpected(ok.error());
  ViewRefs all;
  for (const FlangeView& view : views) all.push_back(&view);
  const RobotWorld solution = fit(all, camera, options);
  HandEye result;
  result.T_base_camera = solution.T_base_camera;
  result.T_flange_board = solution.T_flange_board;
  result.reprojection_rms_px = reprojection_rms(all, camera, solution);
  result.held_out = held_out_errors(views, board, camera, options);
  result.position_rms_m = rms(result.held_out, &ViewError::position_m);
  result.rotation_rms_rad = rms(result.held_out, &ViewError::rotation_rad);
  const ViewRefs kept = consistent(views, result.held_out);
  result.square_m = refine(kept, camera, options, solution, true).scale * board.square_m;
  if (auto ok = check_square(result.square_m, board, options); !ok) {
    return tl::unexpected(ok.error());
  }
  return result;
}

}  // namespace graspd::calibration
