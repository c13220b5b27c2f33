#include "graspd/calibration/depth_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "graspd/types/camera_model.hpp"

namespace graspd::calibration {
namespace {

constexpr std::size_t kMinViews = 3;
constexpr std::size_t kMinReadings = 500;  ///< of the board, in each view
constexpr double kMaxOff_m = 0.08;         ///< more than any device is off: not the board
constexpr int kCell_px = 8;
constexpr double kNoise_m = 0.0015;
/// Priors, as far as any device may be off: they hold what the views do not show.
constexpr double kOffset_m = 0.05;
constexpr double kSlope = 0.05;

using Vector12d = Eigen::Matrix<double, 12, 1>;

/// A reading of the board: how far in front of it, and where.
struct Reading {
  Eigen::Vector3d ray;
  double z_m = 0;
  double near_m = 0;  ///< true depth less the reading
  int cell = 0;
};

using Readings = std::vector<Reading>;  ///< of one view

bool is_plain(const Eigen::Vector3d& p_board_m, const Board& board) {
  const Eigen::Vector2d size_m = board.size_m();
  const Eigen::Vector2d p = p_board_m.head<2>();
  const auto within = [&](double margin_m) {
    return (p.array() >= -margin_m).all() && (p.array() <= size_m.array() + margin_m).all();
  };
  if (board.margin_m == 0) return within(0);
  return within(board.margin_m) && !within(0);
}

Readings read_view(const DepthView& view, const Board& board, const CameraIntrinsics& camera) {
  Readings read;
  const Eigen::Isometry3d T_board_camera = view.T_camera_board.inverse();
  const Eigen::Vector3d normal = view.T_camera_board.linear().col(2);
  const double distance_m = normal.dot(view.T_camera_board.translation());
  const int cells_across_n = (camera.width_px + kCell_px - 1) / kCell_px;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      if (view.depth.at(u, v) == 0) continue;
      const Eigen::Vector3d ray = ray_through(camera, u, v);
      const double true_m = distance_m / normal.dot(ray);
      const double z_m = view.depth.at(u, v) * view.depth.depth_scale_m;
      if (!(true_m > 0) || std::abs(true_m - z_m) > kMaxOff_m) continue;
      if (!is_plain(T_board_camera * (true_m * ray), board)) continue;
      read.push_back({ray, z_m, true_m - z_m, v / kCell_px * cells_across_n + u / kCell_px});
    }
  }
  return read;
}

double held(double z_m, const DepthCorrection& correction) {
  return std::clamp(z_m, correction.min_depth_m, correction.max_depth_m) - correction.reference_m;
}

Vector12d terms_of(const Reading& reading, const DepthCorrection& correction) {
  const Eigen::Matrix<double, 6, 1> terms = depth_correction_terms(reading.ray);
  Vector12d both;
  both << terms, held(reading.z_m, correction) * terms;
  return both;
}

/// Least squares with priors. A view has the same say however near, hence large, the board was.
DepthCorrection fit(const std::vector<const Readings*>& views) {
  DepthCorrection correction;
  correction.min_depth_m = HUGE_VAL;
  double sum_m = 0;
  double readings_n = 0;
  for (const Readings* view : views) {
    for (const Reading& reading : *view) {
      correction.min_depth_m = std::min(correction.min_depth_m, reading.z_m);
      correction.max_depth_m = std::max(correction.max_depth_m, reading.z_m);
      sum_m += reading.z_m;
    }
    readings_n += static_cast<double>(view->size());
  }
  correction.reference_m = sum_m / readings_n;

  Vector12d prior;
  prior << Eigen::Matrix<double, 6, 1>::Constant(kNoise_m / kOffset_m),
      Eigen::Matrix<double, 6, 1>::Constant(kNoise_m / kSlope);
  Eigen::Matrix<double, 12, 12> A = prior.cwiseAbs2().asDiagonal();
  Vector12d b = Vector12d::Zero();
  for (const Readings* view : views) {
    const double weight = static_cast<double>(kMinReadings) / static_cast<double>(view->size());
    for (const Reading& reading : *view) {
      const Vector12d terms = terms_of(reading, correction);
      A.selfadjointView<Eigen::Lower>().rankUpdate(terms, weight);
      b += weight * reading.near_m * terms;
    }
  }
  const Vector12d x = A.selfadjointView<Eigen::Lower>().ldlt().solve(b);
  std::copy(x.data(), x.data() + 6, correction.offset_m.begin());
  std::copy(x.data() + 6, x.data() + 12, correction.slope.begin());
  return correction;
}

/// Errors of readings, all together and averaged over cells.
class ErrorSum {
 public:
  void add(const Readings& view, const DepthCorrection& correction) {
    Vector12d x;
    std::copy(correction.offset_m.begin(), correction.offset_m.end(), x.data());
    std::copy(correction.slope.begin(), correction.slope.end(), x.data() + 6);
    std::map<int, std::pair<double, int>> cells;
    for (const Reading& reading : view) {
      const double left_m = reading.near_m - terms_of(reading, correction).dot(x);
      sum_m_ += left_m;
      sum_m2_ += left_m * left_m;
      auto& [sum_m, n] = cells[reading.cell];
      sum_m += left_m;
      ++n;
    }
    readings_n_ += view.size();
    for (const auto& [cell, sum] : cells) {
      if (sum.second < kCell_px * kCell_px / 2) continue;  // at the board's edge
      const double mean_m = sum.first / sum.second;
      cells_m2_ += mean_m * mean_m;
      ++cells_n_;
    }
  }
  DepthError error() const {
    const auto n = static_cast<double>(readings_n_);
    return {sum_m_ / n, std::sqrt(sum_m2_ / n)};
  }
  double bias_m() const {
    return std::sqrt(cells_m2_ / static_cast<double>(std::max(cells_n_, 1)));
  }
  std::size_t readings_n() const { return readings_n_; }

 private:
  double sum_m_ = 0;
  double sum_m2_ = 0;
  std::size_t readings_n_ = 0;
  double cells_m2_ = 0;
  int cells_n_ = 0;
};

double image_share(const std::vector<Readings>& views, const CameraIntrinsics& camera) {
  std::map<int, int> seen;
  for (const Readings& view : views) {
    for (const Reading& reading : view) ++seen[reading.cell];
  }
  const double cells_n = static_cast<double>(camera.width_px) * camera.height_px /
                         static_cast<double>(kCell_px * kCell_px);
  return std::min(1.0, static_cast<double>(seen.size()) / cells_n);
}

Result<std::vector<Readings>> read_views(std::span<const DepthView> views, const Board& board,
                                         const CameraIntrinsics& camera) {
  if (views.size() < kMinViews) {
    return invalid(
        "{} views show the board with a depth image, at least {} are needed, at distances from "
        "the bin's floor to its rim and over all of the image",
        views.size(), kMinViews);
  }
  std::vector<Readings> read;
  for (const DepthView& view : views) {
    if (view.depth.camera.width_px != camera.width_px ||
        view.depth.camera.height_px != camera.height_px) {
      return invalid("{}: the depth image has {} × {} pixels, the camera {} × {}", view.name,
                     view.depth.camera.width_px, view.depth.camera.height_px, camera.width_px,
                     camera.height_px);
    }
    read.push_back(read_view(view, board, camera));
    if (read.back().size() < kMinReadings) {
      return invalid(
          "{}: {} depth readings lie on the board, at least {} are needed; are depth and infrared "
          "image of the same moment, and both mirrored or neither?",
          view.name, read.back().size(), kMinReadings);
    }
  }
  return read;
}

}  // namespace

Result<DepthFit> fit_depth_correction(std::span<const DepthView> views, const Board& board,
                                      const CameraIntrinsics& camera) {
  const auto read = read_views(views, board, camera);
  if (!read) return tl::unexpected(read.error());
  ErrorSum before;
  ErrorSum held_out;
  std::vector<const Readings*> all;
  for (const Readings& view : *read) {
    std::vector<const Readings*> others;
    for (const Readings& other : *read) {
      if (&other != &view) others.push_back(&other);
    }
    before.add(view, {});
    held_out.add(view, fit(others));
    all.push_back(&view);
  }
  return DepthFit{
      fit(all),          before.error(),      held_out.error(),          before.bias_m(),
      held_out.bias_m(), before.readings_n(), image_share(*read, camera)};
}

}  // namespace graspd::calibration
