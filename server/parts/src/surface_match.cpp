#include "surface_match.hpp"

#include <algorithm>
#include <cmath>

#include "visit_surface.hpp"

namespace graspd::parts {
namespace {

constexpr double kAreaPoints = 1000;
constexpr std::size_t kMaxVertices = 500;
constexpr double kOnSurface_m = 1e-6;
constexpr std::size_t kRoughPoints = 150;
constexpr int kMaxIterations = 6;
constexpr double kSettled_rad = 1e-8;

std::vector<Triangle> triangles_about(const Mesh& mesh, const Eigen::Vector3d& centre_m) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& indices : mesh.triangles) {
    Triangle& triangle = triangles.emplace_back(triangle_of(mesh, indices));
    for (Eigen::Vector3d& corner_m : triangle.corners_m) corner_m -= centre_m;
  }
  return triangles;
}

/// At most `limit` of them, evenly by place in the list, in an order that jumps about: a test that
/// fails anywhere on the surface fails soon.
std::vector<Eigen::Vector3d> scattered(const std::vector<Eigen::Vector3d>& points,
                                       std::size_t limit) {
  constexpr double kGoldenRatio = 0.61803398874989484820;
  const std::size_t n = std::min(points.size(), limit);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < n; ++i) {
    const double key = static_cast<double>(i) * kGoldenRatio;
    order.emplace_back(key - std::floor(key), i * points.size() / n);
  }
  std::sort(order.begin(), order.end());
  std::vector<Eigen::Vector3d> result;
  for (const auto& [key, i] : order) result.push_back(points[i]);
  return result;
}

}  // namespace

SurfaceMatch::SurfaceMatch(const Mesh& mesh)
    : centre_m_(barycentre_m(mesh)), tree_(triangles_about(mesh, centre_m_)) {
  for (const auto& vertex_m : mesh.vertices_m) {  // where a turned surface is off by most
    points_m_.push_back(vertex_m.cast<double>() - centre_m_);
  }
  points_m_ = scattered(points_m_, kMaxVertices);
  // One that only triangles without area have need not lie on the surface.
  std::erase_if(points_m_, [this](const auto& p_m) { return !tree_.is_within(p_m, kOnSurface_m); });
  const auto vertices_n = static_cast<std::ptrdiff_t>(points_m_.size());
  visit_surface(mesh, kAreaPoints / surface_area_m2(mesh), [this](const SurfacePoint& point) {
    points_m_.push_back(point.position_m.cast<double>() - centre_m_);
  });
  rough_points_m_ = scattered({points_m_.begin() + vertices_n, points_m_.end()}, kRoughPoints);
  points_m_ = scattered(points_m_, points_m_.size());
}

bool SurfaceMatch::covers(std::vector<Eigen::Vector3d>& points_m, const Eigen::Quaterniond& turn,
                          double distance_m) const {
  const Eigen::Matrix3d R = turn.toRotationMatrix();
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (tree_.is_within(R * points_m[i], distance_m)) continue;
    std::swap(points_m[i], points_m[i / 2]);
    return false;
  }
  return true;
}

bool SurfaceMatch::covers(const Eigen::Quaterniond& turn, double distance_m) {
  return covers(points_m_, turn, distance_m);
}

bool SurfaceMatch::covers_roughly(const Eigen::Quaterniond& turn, double distance_m) {
  return covers(rough_points_m_, turn, distance_m);
}

Eigen::Quaterniond SurfaceMatch::settled(const Eigen::Quaterniond& turn) const {
  Eigen::Quaterniond result = turn;
  for (int i = 0; i < kMaxIterations; ++i) {
    Eigen::Matrix3d JtJ = Eigen::Matrix3d::Zero();
    Eigen::Vector3d Jtr = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p_m : rough_points_m_) {
      const Eigen::Vector3d turned_m = result * p_m;
      const TriangleTree::Foot foot = tree_.nearest(turned_m);
      const Eigen::Vector3d normal = foot.triangle->area_vector_m2().normalized();
      const Eigen::Vector3d J = turned_m.cross(normal);
      JtJ += J * J.transpose();
      Jtr += J * normal.dot(foot.position_m - turned_m);
    }
    // About the axis of a round part nothing holds the turn: the damping does.
    JtJ.diagonal().array() += 1e-6 * JtJ.trace();
    const Eigen::Vector3d step_rad = JtJ.ldlt().solve(Jtr);
    const double angle_rad = step_rad.norm();
    if (angle_rad < kSettled_rad) break;
    result = (Eigen::AngleAxisd(angle_rad, step_rad / angle_rad) * result).normalized();
  }
  return result;
}

}  // namespace graspd::parts
