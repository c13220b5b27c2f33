#include "graspd/perception/bin_drift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "graspd/types/camera_model.hpp"

namespace graspd::perception {
namespace {

constexpr double kSearch_m = 0.05;
constexpr int kTurns = 15;  ///< that are tried, each way
constexpr double kTurnStep_rad = 0.008;
constexpr double kVoteCell_m = 0.002;
/// Between lines of readings, along a wall; none so near to its ends.
constexpr double kLineSpacing_m = 0.008;
constexpr double kCornerMargin_m = 0.02;
/// Of a wall's height: the rim itself is blurred, and what lies on the floor is below.
constexpr double kRimMargin_m = 0.012;
constexpr double kLeastHeightShare = 0.3;
constexpr double kLeastHeight_m = 0.03;
/// A wall seen flatter than this is not seen.
constexpr double kLeastFacing_m = 0.02;
constexpr double kInlier_m = 0.004;
/// Weight, in readings, of the expectation that walls are seen where they are: it decides only
/// where no two walls that face each other say how far inwards or outwards they seem to be.
constexpr double kUnbent_n = 1;
constexpr int kRefinements = 4;
/// Of the lines across visible walls, those with a reading on a wall; in each direction at least.
constexpr double kLeastSeenShare = 0.35;
constexpr int kFewestLines = 8;
/// Of readings on the walls over those as near behind them.
constexpr double kOverBehind = 2.5;

/// An inner wall, in the bin's frame.
struct Wall {
  Eigen::Vector3d normal;  ///< outwards
  Eigen::Vector3d along;
  double offset_m;  ///< of the wall from the middle
  double length_m;
};

/// What the readings say of the walls: shift along x and y, turn about z, and by how much farther
/// out than they are all of them seem to be, since light also comes to the sensor by way of them.
using Drift = Eigen::Vector4d;

/// A reading that may be on a wall.
struct WallReading {
  std::size_t wall;        ///< index
  Eigen::Vector3d normal;  ///< of that wall
  double beyond_m;         ///< the expected wall
  double lever_m;          ///< by how much a turn of 1 rad moves the wall there along its normal
  int line;
};

std::array<Wall, 4> walls_of(const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  return {Wall{x, y, size_m.x() / 2, size_m.y()}, Wall{-x, y, size_m.x() / 2, size_m.y()},
          Wall{y, x, size_m.y() / 2, size_m.x()}, Wall{-y, x, size_m.y() / 2, size_m.x()}};
}

/// Collects the readings near one bin's walls.
class WallReader {
 public:
  WallReader(const DepthFrame& frame, const Eigen::Isometry3d& T_camera_bin,
             const Eigen::Vector3d& size_m, double wall_bow_m)
      : frame_(frame),
        T_camera_bin_(T_camera_bin),
        T_bin_camera_(T_camera_bin.inverse()),
        wall_bow_m_(wall_bow_m),
        low_m_(kLeastHeightShare * size_m.z()),
        high_m_(size_m.z() - kRimMargin_m),
        rim_m_(size_m.z()),
        search_m_(std::min(kSearch_m, size_m.head<2>().minCoeff() / 4)) {}

  void read(std::size_t index, const Wall& wall) {
    wall_ = index;
    // The camera must stand before the wall, not above or behind it.
    if (T_bin_camera_.translation().dot(wall.normal) > wall.offset_m - kLeastFacing_m) return;
    const double half_m = wall.length_m / 2 - kCornerMargin_m;
    const auto count = static_cast<int>(2 * half_m / kLineSpacing_m) + 1;
    for (int i = 0; i < count; ++i, ++lines_n_) read_line(wall, i * kLineSpacing_m - half_m);
  }

  const std::vector<WallReading>& readings() const { return readings_; }
  int lines_n() const { return lines_n_; }
  double search_m() const { return search_m_; }

 private:
  /// From the deepest and innermost place where the wall may be seen to the highest and outermost.
  void read_line(const Wall& wall, double along_m) {
    const Eigen::Vector3d foot_m = wall.normal * wall.offset_m + wall.along * along_m;
    const Eigen::Vector3d from_m =
        T_camera_bin_ * (foot_m - search_m_ * wall.normal + low_m_ * Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d to_m =
        T_camera_bin_ * (foot_m + search_m_ * wall.normal + rim_m_ * Eigen::Vector3d::UnitZ());
    if (from_m.z() <= 0 || to_m.z() <= 0) return;
    const Eigen::Vector2d from_px = project(frame_.camera, from_m);
    const Eigen::Vector2d step_px = project(frame_.camera, to_m) - from_px;
    const double most_px = 2.0 * kMaxImageSide_px;
    const auto steps_n = static_cast<int>(std::min(most_px, step_px.cwiseAbs().maxCoeff()));
    for (int i = 0; i <= steps_n; ++i) {
      const Eigen::Vector2d pixel = from_px + step_px * i / std::max(1, steps_n);
      const auto u = static_cast<int>(std::lround(pixel.x()));
      const auto v = static_cast<int>(std::lround(pixel.y()));
      if (u >= 0 && v >= 0 && u < frame_.camera.width_px && v < frame_.camera.height_px) {
        read_pixel(wall, u, v);
      }
    }
  }

  void read_pixel(const Wall& wall, int u, int v) {
    const std::uint16_t reading = frame_.at(u, v);
    if (reading == 0) return;
    const double z_m = reading * frame_.depth_scale_m + wall_bow_m_;
    const Eigen::Vector3d p_m = T_bin_camera_ * (z_m * ray_through(frame_.camera, u, v));
    const double beyond_m = wall.normal.dot(p_m) - wall.offset_m;
    if (p_m.z() < low_m_ || p_m.z() > high_m_ || std::abs(beyond_m) > search_m_) return;
    const double lever_m = wall.normal.dot(Eigen::Vector3d::UnitZ().cross(p_m));
    readings_.push_back({wall_, wall.normal, beyond_m, lever_m, lines_n_});
  }

  const DepthFrame& frame_;
  Eigen::Isometry3d T_camera_bin_, T_bin_camera_;
  double wall_bow_m_, low_m_, high_m_, rim_m_, search_m_;
  std::vector<WallReading> readings_;
  std::size_t wall_ = 0;
  int lines_n_ = 0;
};

/// What a reading says of the drift: this times the drift is `beyond_m`.
Eigen::RowVector4d row_of(const WallReading& reading) {
  return {reading.normal.x(), reading.normal.y(), reading.lever_m, 1};
}

/// By how much a reading is off a wall that has drifted.
double error_m(const WallReading& reading, const Drift& drift) {
  return reading.beyond_m - row_of(reading).dot(drift);
}

/// Walls that face each other are as far apart as they seem to be farther out; where one of them is
/// not seen, the other says how far it has moved.
Drift from_peaks(const std::array<double, 4>& beyond_m, const std::array<int, 4>& peak_n,
                 double turn_rad) {
  Drift drift(0, 0, turn_rad, 0);
  int pairs_n = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (peak_n[2 * axis] == 0 || peak_n[2 * axis + 1] == 0) continue;
    drift[3] += (beyond_m[2 * axis] + beyond_m[2 * axis + 1]) / 2;
    ++pairs_n;
  }
  if (pairs_n > 0) drift[3] /= pairs_n;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double sum_m = 0;
    int seen_n = 0;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      if (peak_n[2 * axis + side] == 0) continue;
      sum_m += (side == 0 ? 1 : -1) * (beyond_m[2 * axis + side] - drift[3]);
      ++seen_n;
    }
    if (seen_n > 0) drift[static_cast<Eigen::Index>(axis)] = sum_m / seen_n;
  }
  return drift;
}

/// Where most of each wall's readings are, together for the turn that brings them together best.
Drift most_voted(const std::vector<WallReading>& readings, double search_m) {
  const auto cells_n = static_cast<std::size_t>(2 * search_m / kVoteCell_m) + 1;
  std::array<std::vector<int>, 4> votes;
  Drift best = Drift::Zero();
  int most_n = -1;
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    const double turn_rad = turn * kTurnStep_rad;
    for (auto& wall : votes) wall.assign(cells_n, 0);
    for (const WallReading& reading : readings) {
      const double beyond_m = reading.beyond_m - reading.lever_m * turn_rad;
      if (std::abs(beyond_m) > search_m) continue;
      ++votes[reading.wall][static_cast<std::size_t>((beyond_m + search_m) / kVoteCell_m)];
    }
    int votes_n = 0;
    std::array<double, 4> beyond_m{};
    std::array<int, 4> peak_n{};
    for (std::size_t wall = 0; wall < 4; ++wall) {
      const auto peak = std::ranges::max_element(votes[wall]);
      peak_n[wall] = *peak;
      votes_n += *peak;
      beyond_m[wall] =
          (static_cast<double>(peak - votes[wall].begin()) + 0.5) * kVoteCell_m - search_m;
    }
    if (votes_n <= most_n) continue;
    most_n = votes_n;
    best = from_peaks(beyond_m, peak_n, turn_rad);
  }
  return best;
}

/// Least squares with Tukey's weights, from nearby.
Drift refined(const std::vector<WallReading>& readings, Drift drift) {
  for (int i = 0; i < kRefinements; ++i) {
    Eigen::Matrix4d A = Eigen::Vector4d(1e-9, 1e-9, 1e-9, kUnbent_n).asDiagonal();
    Drift b = Drift::Zero();
    for (const WallReading& reading : readings) {
      const double share = error_m(reading, drift) / kInlier_m;
      if (std::abs(share) >= 1) continue;
      const double weight = (1 - share * share) * (1 - share * share);
      const Eigen::RowVector4d row = row_of(reading);
      A += weight * row.transpose() * row;
      b += weight * row.transpose() * reading.beyond_m;
    }
    drift = A.ldlt().solve(b);
  }
  return drift;
}

/// Whether enough lines have a reading on a wall, in both directions, and next to none just behind
/// it: noise is as thick there.
bool is_seen(const std::vector<WallReading>& readings, const Drift& drift, int lines_n) {
  std::array<int, 2> lines_seen_n{};
  int on_wall_n = 0;
  int behind_n = 0;
  int last_line = -1;
  for (const WallReading& reading : readings) {
    const double error = error_m(reading, drift);
    behind_n += error > kInlier_m && error <= 3 * kInlier_m;
    if (std::abs(error) > kInlier_m) continue;
    ++on_wall_n;
    if (reading.line == last_line) continue;
    last_line = reading.line;
    ++lines_seen_n[reading.normal.x() != 0 ? 0 : 1];
  }
  return std::ranges::min(lines_seen_n) >= kFewestLines &&
         lines_seen_n[0] + lines_seen_n[1] >= kLeastSeenShare * lines_n &&
         on_wall_n >= kOverBehind * behind_n;
}

}  // namespace

std::optional<BinDrift> find_bin_drift(const DepthFrame& frame,
                                       const Eigen::Isometry3d& T_camera_bin,
                                       const Eigen::Vector3d& inner_size_m,
                                       const PreprocessParameters& parameters) {
  if (inner_size_m.z() < kLeastHeight_m) return std::nullopt;
  WallReader reader(frame, T_camera_bin, inner_size_m, parameters.wall_bow_m);
  const auto walls = walls_of(inner_size_m);
  for (std::size_t i = 0; i < walls.size(); ++i) reader.read(i, walls[i]);
  const auto& readings = reader.readings();
  if (readings.empty()) return std::nullopt;
  const Drift drift = refined(readings, most_voted(readings, reader.search_m()));
  if (!is_seen(readings, drift, reader.lines_n())) return std::nullopt;

  BinDrift found{drift.head<2>(), drift.z(), 0};
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Eigen::Vector2d corner_m = inner_size_m.head<2>().cwiseProduct(Eigen::Vector2d(x, y));
      const Eigen::Vector2d moved_m =
          found.shift_m + Eigen::Rotation2Dd(found.turn_rad) * corner_m - corner_m;
      found.corner_m = std::max(found.corner_m, moved_m.norm());
    }
  }
  return found;
}

std::string sentence_of(const BinDrift& drift) {
  return fmt::format(
      "the bin lies {:.1f} mm along its x axis, {:.1f} mm along its y axis and {:.1f}° from where "
      "the request says, its rim by up to {:.1f} mm: correct T_base_bin, or push the bin back",
      drift.shift_m.x() * 1e3, drift.shift_m.y() * 1e3, drift.turn_rad * 180 / M_PI,
      drift.corner_m * 1e3);
}

}  // namespace graspd::perception
