#include "graspd/eval/pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace graspd::eval {
namespace {

constexpr int kContinuousSteps = 315;  // 2π / 0.02: the rim moves by a hundredth of the diameter

std::vector<Eigen::Isometry3d> turns(const parts::ContinuousSymmetry& symmetry) {
  std::vector<Eigen::Isometry3d> result;
  for (int i = 0; i < kContinuousSteps; ++i) {
    const Eigen::AngleAxisd turn(2 * M_PI * i / kContinuousSteps, symmetry.axis.normalized());
    result.push_back(Eigen::Translation3d(symmetry.point_m) * turn *
                     Eigen::Translation3d(-symmetry.point_m));
  }
  return result;
}

/// The points whose distances matter: the mesh's vertices, where the largest distance is reached.
double largest_distance_m(const parts::Part& part, const Eigen::Isometry3d& T_a,
                          const Eigen::Isometry3d& T_b, double give_up_m) {
  double largest2 = 0;
  for (const auto& vertex : part.mesh.vertices_m) {
    const Eigen::Vector3d p = vertex.cast<double>();
    largest2 = std::max(largest2, (T_a * p - T_b * p).squaredNorm());
    if (largest2 >= give_up_m * give_up_m) break;
  }
  return std::sqrt(largest2);
}

/// The identity and the discrete symmetries.
std::vector<Eigen::Isometry3d> discrete_symmetries(const parts::Part& part) {
  std::vector<Eigen::Isometry3d> symmetries{Eigen::Isometry3d::Identity()};
  symmetries.insert(symmetries.end(), part.symmetries.discrete.begin(),
                    part.symmetries.discrete.end());
  return symmetries;
}

/// The angle of the rotation that is left after the best turn about the continuous axes.
double least_angle_rad(const Eigen::Matrix3d& R, std::span<const parts::ContinuousSymmetry> axes) {
  if (axes.size() > 1) return 0;
  const Eigen::Quaterniond q(R);
  // A turn by 2φ makes the product's real part w cos φ − (v · a) sin φ, at best √(w² + (v · a)²).
  const double along = axes.empty() ? 0 : q.vec().dot(axes.front().axis.normalized());
  const double across = std::sqrt(std::max(0.0, q.vec().squaredNorm() - along * along));
  return 2 * std::atan2(across, std::hypot(q.w(), along));
}

}  // namespace

std::vector<Eigen::Isometry3d> all_symmetries(const parts::Part& part) {
  std::vector<Eigen::Isometry3d> symmetries = discrete_symmetries(part);
  for (const auto& continuous : part.symmetries.continuous) {
    std::vector<Eigen::Isometry3d> product;
    for (const auto& symmetry : symmetries) {
      for (const auto& turn : turns(continuous)) product.push_back(symmetry * turn);
    }
    symmetries = std::move(product);
  }
  return symmetries;
}

double mssd_m(const parts::Part& part, const Eigen::Isometry3d& T_camera_part_estimated,
              const Eigen::Isometry3d& T_camera_part_true) {
  double least_m = std::numeric_limits<double>::max();
  for (const auto& symmetry : all_symmetries(part)) {
    least_m = std::min(least_m, largest_distance_m(part, T_camera_part_estimated,
                                                   T_camera_part_true * symmetry, least_m));
  }
  return least_m;
}

PoseError pose_error(const parts::Part& part, const Eigen::Isometry3d& T_camera_part_estimated,
                     const Eigen::Isometry3d& T_camera_part_true) {
  const double largest = std::numeric_limits<double>::max();
  PoseError least{largest, largest};
  const Eigen::Vector3d barycentre_m = T_camera_part_estimated * part.barycentre_m;
  for (const auto& symmetry : discrete_symmetries(part)) {
    const Eigen::Isometry3d T_camera_part = T_camera_part_true * symmetry;
    least.translation_m =
        std::min(least.translation_m, (barycentre_m - T_camera_part * part.barycentre_m).norm());
    least.rotation_rad = std::min(
        least.rotation_rad,
        least_angle_rad(T_camera_part_estimated.linear().transpose() * T_camera_part.linear(),
                        part.symmetries.continuous));
  }
  return least;
}

}  // namespace graspd::eval
