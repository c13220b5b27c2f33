#include "graspd/eval/pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

std::vector<Eigen::Isometry3d> all_symmetries(const parts::Part& part) {
  std::vector<Eigen::Isometry3d> symmetries{Eigen::Isometry3d::Identity()};
  symmetries.insert(symmetries.end(), part.symmetries.discrete.begin(),
                    part.symmetries.discrete.end());
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

}  // namespace graspd::eval
