#include "sensor_comparison_measures.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <vector>

namespace graspd::bench {
namespace {

constexpr int kPatch_px = 11;
constexpr double kOnFloor_mm = 8;  // from its plane: noise, bend, and nothing else
constexpr double kOnPart_mm = 15;
constexpr double kLeastStep_mm = 25;
constexpr int kLongestEdge_px = 12;
constexpr double kSameEdge_px = 4;
constexpr double kFlying_mm = 8;
constexpr int kPlaneRounds = 5;

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double z_mm(const DepthFrame& frame, int u, int v) {
  return frame.at(u, v) * frame.depth_scale_m * 1e3;
}

Eigen::Vector3d point_mm(const DepthFrame& frame, int u, int v) {
  const CameraIntrinsics& camera = frame.camera;
  return Eigen::Vector3d((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1) *
         z_mm(frame, u, v);
}

template <class Visit>
void for_each_pixel(const PixelBox& box, Visit visit) {
  for (int v = box.v_first; v < box.v_end; ++v) {
    for (int u = box.u_first; u < box.u_end; ++u) visit(u, v);
  }
}

/// z = a u + b v + c through the readings of a box that `use` accepts.
template <class Use>
Eigen::Vector3d fit_plane(const DepthFrame& frame, const PixelBox& box, Use use) {
  Eigen::Matrix3d AtA = Eigen::Matrix3d::Zero();
  Eigen::Vector3d Atz = Eigen::Vector3d::Zero();
  for_each_pixel(box, [&](int u, int v) {
    if (frame.at(u, v) == 0 || !use(u, v)) return;
    const Eigen::Vector3d row(u - box.u_first, v - box.v_first, 1);
    AtA += row * row.transpose();
    Atz += row * z_mm(frame, u, v);
  });
  return AtA.ldlt().solve(Atz);
}

/// The floor's plane, and heights above it along its normal.
class Floor {
 public:
  Floor(const DepthFrame& frame, const PixelBox& box) : frame_(frame) {
    std::vector<double> depths_mm;
    for_each_pixel(box, [&](int u, int v) {
      if (frame.at(u, v) > 0) depths_mm.push_back(z_mm(frame, u, v));
    });
    plane_ = Eigen::Hyperplane<double, 3>(Eigen::Vector3d(0, 0, -1), median(depths_mm));
    // Parts are outliers above: each round keeps what is nearer to the last plane.
    for (int round = 0; round < kPlaneRounds; ++round) {
      const double kept_mm = 3 * kOnFloor_mm / (round + 1) + kOnFloor_mm;
      refit(box, kept_mm);
    }
  }

  double height_mm(int u, int v) const { return plane_.signedDistance(point_mm(frame_, u, v)); }

 private:
  void refit(const PixelBox& box, double kept_mm) {
    std::vector<Eigen::Vector3d> points;
    for_each_pixel(box, [&](int u, int v) {
      if (frame_.at(u, v) > 0 && std::abs(height_mm(u, v)) < kept_mm) {
        points.push_back(point_mm(frame_, u, v));
      }
    });
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& p : points) centre += p / double(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points) scatter += (p - centre) * (p - centre).transpose();
    Eigen::Vector3d normal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
    if (normal.z() > 0) normal = -normal;
    plane_ = Eigen::Hyperplane<double, 3>(normal, centre);
  }

  const DepthFrame& frame_;
  Eigen::Hyperplane<double, 3> plane_;
};

void measure_noise(const DepthFrame& frame, const PixelBox& box, const Floor& floor,
                   SensorMeasures& measures) {
  std::vector<double> sigmas_mm, correlations;
  for (int v = box.v_first; v + kPatch_px <= box.v_end; v += kPatch_px) {
    for (int u = box.u_first; u + kPatch_px <= box.u_end; u += kPatch_px) {
      const PixelBox patch{u, v, u + kPatch_px, v + kPatch_px};
      bool flat = true;
      for_each_pixel(patch, [&](int x, int y) {
        flat = flat && frame.at(x, y) > 0 && std::abs(floor.height_mm(x, y)) < kOnFloor_mm;
      });
      if (!flat) continue;
      const Eigen::Vector3d plane = fit_plane(frame, patch, [](int, int) { return true; });
      const auto residual_mm = [&](int x, int y) {
        return z_mm(frame, x, y) - plane.dot(Eigen::Vector3d(x - u, y - v, 1));
      };
      double squares = 0, products = 0;
      for_each_pixel(patch, [&](int x, int y) {
        squares += residual_mm(x, y) * residual_mm(x, y);
        if (x > u) products += residual_mm(x, y) * residual_mm(x - 1, y);
      });
      const double pixels_n = kPatch_px * kPatch_px;
      sigmas_mm.push_back(std::sqrt(squares / (pixels_n - 3)));
      correlations.push_back((products / (kPatch_px * (kPatch_px - 1))) / (squares / pixels_n));
    }
  }
  measures.plane_noise_mm = median(sigmas_mm);
  measures.noise_correlation = median(correlations);
}

double floor_bend_mm(const DepthFrame& frame, const PixelBox& box, const Floor& floor) {
  std::vector<double> near_mm, middle_mm;
  for_each_pixel(box, [&](int u, int v) {
    if (frame.at(u, v) == 0 || std::abs(floor.height_mm(u, v)) > 2 * kOnFloor_mm) return;
    const int to_wall_px =
        std::min({u - box.u_first, box.u_end - 1 - u, v - box.v_first, box.v_end - 1 - v});
    const double to_wall_mm = to_wall_px * z_mm(frame, u, v) / frame.camera.fx_px;
    if (to_wall_mm >= 10 && to_wall_mm < 20) near_mm.push_back(floor.height_mm(u, v));
    if (to_wall_mm >= 60) middle_mm.push_back(floor.height_mm(u, v));
  });
  return median(near_mm) - median(middle_mm);
}

/// Where the profile first reaches `level`, between its samples.
double crossing_px(const std::vector<double>& profile, double level) {
  for (std::size_t i = 1; i < profile.size(); ++i) {
    if (profile[i] >= level) {
      return double(i) - (profile[i] - level) / (profile[i] - profile[i - 1]);
    }
  }
  return double(profile.size());
}

struct Step {
  double middle_px = 0;  ///< from where the step was looked for
  double width_px = 0;   ///< from 10 to 90 % of its height
};

/// From pixel to pixel, along a row or a column.
struct Direction {
  int du = 0;
  int dv = 0;
};

/// The step that starts at (u, v) on the floor and climbs along `to` for as long as it rises by
/// a millimetre a pixel; nothing where there is no step.
std::optional<Step> find_step(const DepthFrame& frame, const Floor& floor, int u, int v,
                              Direction to) {
  std::vector<double> profile;
  for (int i = 0; i <= kLongestEdge_px; ++i) {
    if (frame.at(u + i * to.du, v + i * to.dv) == 0) return std::nullopt;
    const double height_mm = floor.height_mm(u + i * to.du, v + i * to.dv);
    if (i > 0 && height_mm < profile.back() + 1) break;
    profile.push_back(height_mm);
  }
  const double step_mm = profile.back() - profile.front();
  if (step_mm < kLeastStep_mm) return std::nullopt;
  const auto at = [&](double share) {
    return crossing_px(profile, profile.front() + share * step_mm);
  };
  return Step{at(0.5), at(0.9) - at(0.1)};
}

void measure_edges(const DepthFrame& frame, const PixelBox& box, const Floor& floor,
                   SensorMeasures& measures) {
  std::vector<double> widths_px, jumps_px;
  const PixelBox inside{box.u_first + kLongestEdge_px, box.v_first + kLongestEdge_px,
                        box.u_end - kLongestEdge_px, box.v_end - kLongestEdge_px};
  for (const Direction to : {Direction{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    // Where each row (or column) meets its first step, by the row's number.
    std::map<int, double> places_px;
    for_each_pixel(inside, [&](int u, int v) {
      if (frame.at(u, v) == 0 || std::abs(floor.height_mm(u, v)) > kOnFloor_mm) return;
      const auto step = find_step(frame, floor, u, v, to);
      if (!step) return;
      widths_px.push_back(step->width_px);
      const int row = to.du != 0 ? v : u;
      const double place_px = (to.du != 0 ? u : v) + (to.du + to.dv) * step->middle_px;
      places_px.try_emplace(row, place_px);
    });
    for (const auto& [row, place_px] : places_px) {
      const auto before = places_px.find(row - 1), after = places_px.find(row + 1);
      if (before == places_px.end() || after == places_px.end()) continue;
      const double bend_px = before->second - 2 * place_px + after->second;
      if (std::abs(bend_px) < kSameEdge_px) jumps_px.push_back(std::abs(bend_px));
    }
  }
  measures.edge_width_px = median(widths_px);
  // Of three independent places a, b, c with the same σ, a − 2b + c has σ √6, and its median size
  // is 0.6745 of that.
  measures.edge_roughness_px = median(jumps_px) / (0.6745 * std::sqrt(6.0));
}

void measure_parts(const DepthFrame& frame, const PixelBox& box, const Floor& floor,
                   SensorMeasures& measures) {
  std::vector<double> slopes_mm;
  int parts_n = 0, flying_n = 0;
  const PixelBox inside{box.u_first + 1, box.v_first + 1, box.u_end - 1, box.v_end - 1};
  for_each_pixel(inside, [&](int u, int v) {
    if (frame.at(u, v) == 0 || floor.height_mm(u, v) < kOnPart_mm) return;
    ++parts_n;
    bool flying = false;
    double steepest_mm = 0;
    for (const auto& [du, dv] : {Direction{1, 0}, {0, 1}}) {
      if (frame.at(u - du, v - dv) == 0 || frame.at(u + du, v + dv) == 0) continue;
      const double before_mm = z_mm(frame, u, v) - z_mm(frame, u - du, v - dv);
      const double after_mm = z_mm(frame, u + du, v + dv) - z_mm(frame, u, v);
      flying = flying || (before_mm * after_mm > 0 &&
                          std::min(std::abs(before_mm), std::abs(after_mm)) > kFlying_mm);
      steepest_mm = std::max(steepest_mm, std::abs(before_mm + after_mm) / 2);
    }
    flying_n += flying;
    if (steepest_mm < kFlying_mm) slopes_mm.push_back(steepest_mm);
  });
  measures.flying_share = double(flying_n) / std::max(1, parts_n);
  measures.slope_on_parts = mean(slopes_mm);
}

double empty_share(const DepthFrame& frame, const PixelBox& box) {
  int empty_n = 0;
  for_each_pixel(box, [&](int u, int v) { empty_n += frame.at(u, v) == 0; });
  return double(empty_n) / ((box.u_end - box.u_first) * (box.v_end - box.v_first));
}

}  // namespace

SensorMeasures measure(const DepthFrame& frame, const PixelBox& within_rim, const PixelBox& floor) {
  const Floor plane(frame, floor);
  SensorMeasures measures;
  measures.empty_share = empty_share(frame, within_rim);
  measures.floor_bend_mm = floor_bend_mm(frame, floor, plane);
  measure_noise(frame, floor, plane, measures);
  measure_edges(frame, floor, plane, measures);
  measure_parts(frame, floor, plane, measures);
  return measures;
}

}  // namespace graspd::bench
