#include "graspd/parts/registration_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "make_pose_templates.hpp"
#include "view_rendering.hpp"

namespace graspd::parts {
namespace {

constexpr int kViews = 240;          // about 13° apart
constexpr double kCellsAcross = 40;  // of a view, over the part's diameter
constexpr int kCubeSide = 24;        // cells of the cube map: 3.75° wide
constexpr std::size_t kReadAhead = 16;
/// From the outline to where the surface must have ended: the sensor blurs an edge over two pixels
/// of 2 mm to either side.
constexpr double kBeyond_m = 0.005;

/// Reorders points so that any leading ones are spread over all: in steps of the golden section.
void spread(std::vector<SurfacePoint>& points) {
  const std::size_t count = points.size();
  auto step = static_cast<std::size_t>(static_cast<double>(count) / std::numbers::phi);
  while (std::gcd(step, count) > 1) ++step;
  std::vector<SurfacePoint> reordered;
  for (std::size_t i = 0; i < count; ++i) reordered.push_back(points[i * step % count]);
  points = std::move(reordered);
}

/// Brings points to the front, each as far across the line of sight as can be from those before it:
/// the very first ones decide whether a hypothesis is looked at further.
void spread_first(std::vector<SurfacePoint>& points, std::size_t count,
                  const Eigen::Vector3f& line_of_sight) {
  std::vector<float> distance2(points.size(), std::numeric_limits<float>::max());
  Eigen::Vector3f last = Eigen::Vector3f::Zero();
  for (const auto& point : points) last += point.position_m / static_cast<float>(points.size());
  for (std::size_t chosen = 0; chosen < std::min(count, points.size()); ++chosen) {
    std::size_t farthest = chosen;
    for (std::size_t i = chosen; i < points.size(); ++i) {
      const Eigen::Vector3f d = points[i].position_m - last;
      const float along = d.dot(line_of_sight);
      distance2[i] = std::min(distance2[i], d.squaredNorm() - along * along);
      if (distance2[i] > distance2[farthest]) farthest = i;
    }
    std::swap(points[chosen], points[farthest]);
    std::swap(distance2[chosen], distance2[farthest]);
    last = points[chosen].position_m;
  }
}

/// Cell of a cube map.
std::size_t cube_cell(const Eigen::Vector3f& direction) {
  int axis = 0;
  const float largest = direction.cwiseAbs().maxCoeff(&axis);
  const int face = 2 * axis + (direction[axis] < 0 ? 1 : 0);
  const auto along = [&](int other) {
    const float at = (direction[other] / largest + 1) / 2 * kCubeSide;
    return std::clamp(static_cast<int>(at), 0, kCubeSide - 1);
  };
  return static_cast<std::size_t>((face * kCubeSide + along((axis + 1) % 3)) * kCubeSide +
                                  along((axis + 2) % 3));
}

/// The middle of a cell.
Eigen::Vector3f cube_direction(int cell) {
  const int face = cell / (kCubeSide * kCubeSide);
  const auto at = [](int index) { return (static_cast<float>(index) + 0.5F) / kCubeSide * 2 - 1; };
  Eigen::Vector3f direction;
  direction[face / 2] = face % 2 == 0 ? 1.0F : -1.0F;
  direction[(face / 2 + 1) % 3] = at(cell / kCubeSide % kCubeSide);
  direction[(face / 2 + 2) % 3] = at(cell % kCubeSide);
  return direction;
}

}  // namespace

std::vector<Eigen::Vector3f> spread_directions(int count) {
  const double golden_rad = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double r = std::sqrt(1 - z * z);
    directions.push_back(
        Eigen::Vector3d(r * std::cos(golden_rad * i), r * std::sin(golden_rad * i), z)
            .cast<float>());
  }
  return directions;
}

void PointArrays::push_back(const SurfacePoint& point) {
  x_m.push_back(point.position_m.x());
  y_m.push_back(point.position_m.y());
  z_m.push_back(point.position_m.z());
  nx.push_back(point.normal.x());
  ny.push_back(point.normal.y());
  nz.push_back(point.normal.z());
}

RegistrationModel::RegistrationModel(const Mesh& mesh, const Symmetries& symmetries) {
  const double across_m = diameter_m(mesh);
  add_views(mesh, across_m);
  templates_ = make_pose_templates(views_, points_, across_m, across_m / kCellsAcross, symmetries);
}

const View& RegistrationModel::view_from(const Eigen::Vector3f& towards_camera) const {
  return views_[nearest_view_[cube_cell(towards_camera)]];
}

void RegistrationModel::add_views(const Mesh& mesh, double diameter_m) {
  const double cell_m = diameter_m / kCellsAcross;
  std::uint32_t largest_n = 1;
  for (const Eigen::Vector3f& direction : spread_directions(kViews)) {
    auto [seen, beyond] = render_view(mesh, direction, cell_m, kBeyond_m);
    spread(seen);
    spread_first(seen, kSpreadPoints, direction);
    const auto count = static_cast<std::uint32_t>(seen.size());
    largest_n = std::max(largest_n, count);
    views_.push_back({direction, static_cast<std::uint32_t>(points_.size()), count,
                      static_cast<std::uint32_t>(beyond_.size()),
                      static_cast<std::uint32_t>(beyond.size()), 0});
    for (const SurfacePoint& point : seen) points_.push_back(point);
    for (const SurfacePoint& point : beyond) beyond_.push_back(point);
  }
  for (View& view : views_) {
    view.area_share = static_cast<float>(view.points_n) / static_cast<float>(largest_n);
  }
  largest_view_m2_ = static_cast<float>(largest_n * cell_m * cell_m);
  for (auto* arrays : {&points_, &beyond_}) {
    for (auto* array :
         {&arrays->x_m, &arrays->y_m, &arrays->z_m, &arrays->nx, &arrays->ny, &arrays->nz}) {
      array->resize(array->size() + kReadAhead);
    }
  }
  for (int cell = 0; cell < 6 * kCubeSide * kCubeSide; ++cell) {
    const Eigen::Vector3f direction = cube_direction(cell);
    const auto nearest =
        std::max_element(views_.begin(), views_.end(), [&](const View& a, const View& b) {
          return a.towards_camera.dot(direction) < b.towards_camera.dot(direction);
        });
    nearest_view_.push_back(static_cast<std::uint16_t>(nearest - views_.begin()));
  }
}

}  // namespace graspd::parts
