#include "graspd/perception/pose_hypothesis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace graspd::perception {
namespace {

constexpr std::size_t kAllPoints = 1U << 30U;
constexpr std::size_t kSearchPoints = 400;
constexpr float kFirstStep_m = 0.003F;
constexpr float kLastStep_m = 0.0006F;
constexpr int kMaxSteps = 8;
constexpr int kFinalIcpSteps = 3;
constexpr double kIcpDamping = 0.02;  ///< of the number of points
/// A normal that agrees counts fully, one that is off by 60° only as half: normals of the image are
/// off by 10° to 20°.
constexpr float kNormalWeight = 0.5F;
constexpr float kAgreeingCosine = 0.9F;
constexpr float kOpposingCosine = 0.5F;

KernelPose for_kernel(const PoseHypothesis& pose) {
  KernelPose result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.R[3 * i + j] = pose.R(i, j);
    result.t_m[i] = pose.t_m[i];
  }
  return result;
}

/// Turns the pose about a point of the camera frame.
void turn(PoseHypothesis& pose, const Eigen::Matrix3f& by, const Eigen::Vector3f& about_m) {
  pose.R = by * pose.R;
  pose.t_m = by * (pose.t_m - about_m) + about_m;
}

/// Back to the nearest rotation, after many products.
void orthonormalise(PoseHypothesis& pose) {
  pose.R = Eigen::Quaternionf(pose.R).normalized().toRotationMatrix();
}

}  // namespace

const parts::View& PoseVerifier::view(const PoseHypothesis& pose) const {
  return part(pose).registration.view_from(-(pose.R.transpose() * pose.t_m));
}

Eigen::Vector3f PoseVerifier::barycentre_m(const PoseHypothesis& pose) const {
  return pose.in_camera(part(pose).barycentre_m.cast<float>());
}

float PoseVerifier::score_of(const PoseCounts& counts, float support,
                             const parts::View& seen) const {
  const auto refuted = static_cast<float>(parameters_.refuted_weight * counts.refute_n);
  return (support - refuted) / static_cast<float>(std::max(1, counts.tested_n)) * seen.area_share;
}

bool PoseVerifier::score(PoseHypothesis& pose, std::size_t points_n, double tolerance_m,
                         const EarlyStop& stop) const {
  const parts::PointArrays& all = part(pose).registration.points();
  const parts::View& seen = view(pose);
  const PointSpan points{all.x_m.data() + seen.first, all.y_m.data() + seen.first,
                         all.z_m.data() + seen.first,
                         std::min<std::size_t>(points_n, seen.points_n)};
  pose.counts = count_evidence(grid_.for_kernel(), for_kernel(pose), points,
                               static_cast<float>(tolerance_m), stop);
  if (static_cast<std::size_t>(pose.counts.tested_n) < points.size) return false;
  // Each supporting point counts 1 − (error / tolerance)².
  const auto tolerance = static_cast<float>(tolerance_m) / PackedDepth::kUnit_m;
  const float support = static_cast<float>(pose.counts.support_n) -
                        static_cast<float>(pose.counts.error2_sum) / (tolerance * tolerance);
  pose.score = score_of(pose.counts, support, seen);
  return true;
}

void PoseVerifier::score_finally(PoseHypothesis& pose) const {
  score(pose, kAllPoints, parameters_.inlier_tolerance_m);
  const parts::PointArrays& points = part(pose).registration.points();
  const parts::View& seen = view(pose);
  float support = 0;
  for (std::uint32_t i = seen.first; i < seen.first + seen.points_n; ++i) {
    const Eigen::Vector3f p_m = pose.in_camera(points.position_m(i));
    const std::size_t cell = grid_.cell_of(p_m);
    if (cell >= grid_.z_m.size() || !grid_.is_open(cell)) continue;
    const float error =
        (grid_.z_m[cell] - p_m.z()) / static_cast<float>(parameters_.inlier_tolerance_m);
    if (std::abs(error) > 1) continue;
    const float cosine =
        grid_.normals[cell].isZero() ? 1 : grid_.normals[cell].dot(pose.R * points.normal(i));
    const float agreement =
        std::clamp((cosine - kOpposingCosine) / (kAgreeingCosine - kOpposingCosine), 0.0F, 1.0F);
    support += (1 - error * error) * (1 - kNormalWeight * (1 - agreement));
  }
  const bool goes_on = leftover_share(pose) > static_cast<float>(parameters_.max_leftover_share);
  const bool is_seen =
      pose.counts.support_n >= parameters_.min_visible_share * pose.counts.tested_n;
  pose.score = is_seen && !goes_on ? score_of(pose.counts, support, seen) : 0;
}

float PoseVerifier::leftover_share(const PoseHypothesis& pose) const {
  const parts::PointArrays& beyond = part(pose).registration.beyond();
  const parts::View& seen = view(pose);
  const PointSpan points{beyond.x_m.data() + seen.beyond_first,
                         beyond.y_m.data() + seen.beyond_first,
                         beyond.z_m.data() + seen.beyond_first, seen.beyond_n};
  const PoseCounts counts = count_evidence(grid_.for_kernel(), for_kernel(pose), points,
                                           static_cast<float>(parameters_.inlier_tolerance_m));
  return static_cast<float>(counts.support_n) / static_cast<float>(std::max(1, counts.tested_n));
}

void PoseVerifier::icp_step(PoseHypothesis& pose, std::size_t points_n, double tolerance_m) const {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const parts::PointArrays& points = part(pose).registration.points();
  const parts::View& seen = view(pose);
  const Eigen::Vector3f centre_m = barycentre_m(pose);
  // Turns in units of the part's radius: all six unknowns are alike in size.
  const auto radius_m = static_cast<float>(part(pose).diameter_m / 2);
  const auto tolerance = static_cast<float>(tolerance_m);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 b = Vector6::Zero();
  int count = 0;
  const auto last = seen.first + std::min<std::size_t>(points_n, seen.points_n);
  for (std::size_t i = seen.first; i < last; ++i) {
    const Eigen::Vector3f p_m = pose.in_camera(points.position_m(i));
    const std::size_t cell = grid_.cell_of(p_m);
    if (cell >= grid_.z_m.size() || !grid_.is_open(cell)) continue;
    const float z_m = grid_.z_m[cell];
    if (std::abs(z_m - p_m.z()) > tolerance) continue;
    const Eigen::Vector3f normal = pose.R * points.normal(i);
    const float distance_m =
        normal.dot(p_m) * (z_m / p_m.z() - 1);  // of the reading from the plane
    const float relative = distance_m / tolerance;
    const float weight = (1 - relative * relative) * (1 - relative * relative);
    Vector6 J;
    J << ((p_m - centre_m) / radius_m).cross(normal).cast<double>(), normal.cast<double>();
    A.noalias() += static_cast<double>(weight) * J * J.transpose();
    b += static_cast<double>(weight * distance_m) * J;
    ++count;
  }
  if (count < 6) return;
  A.diagonal().array() += kIcpDamping * count;
  const Vector6 step = A.ldlt().solve(b);
  const Eigen::Vector3f rotation = (step.head<3>() / static_cast<double>(radius_m)).cast<float>();
  const float angle_rad = rotation.norm();
  if (angle_rad > 1e-9F) {
    turn(pose, Eigen::AngleAxisf(angle_rad, rotation / angle_rad).toRotationMatrix(), centre_m);
  }
  pose.t_m += step.tail<3>().cast<float>();
}

void PoseVerifier::search_nearby(PoseHypothesis& pose) const {
  const auto radius_m = static_cast<float>(part(pose).diameter_m / 2);
  score(pose, kSearchPoints, parameters_.inlier_tolerance_m);
  float step_m = kFirstStep_m;
  for (int i = 0; i < kMaxSteps && step_m > kLastStep_m; ++i) {
    PoseHypothesis best = pose;
    for (int direction = 0; direction < 12; ++direction) {
      const float signed_step_m = direction % 2 == 0 ? step_m : -step_m;
      const Eigen::Vector3f axis = Eigen::Vector3f::Unit(direction / 2 % 3);
      PoseHypothesis trial = pose;
      if (direction < 6) {
        trial.t_m += signed_step_m * axis;
      } else {
        turn(trial, Eigen::AngleAxisf(signed_step_m / radius_m, axis).toRotationMatrix(),
             barycentre_m(pose));
      }
      score(trial, kSearchPoints, parameters_.inlier_tolerance_m);
      if (trial.score > best.score) best = trial;
    }
    if (best.score > pose.score) {
      pose = best;
    } else {
      step_m /= 2;
    }
  }
}

void PoseVerifier::refine(PoseHypothesis& pose) const {
  for (int i = 0; i < kFinalIcpSteps; ++i) {
    icp_step(pose, kAllPoints, parameters_.inlier_tolerance_m);
  }
  orthonormalise(pose);
  search_nearby(pose);
  // The search goes in steps of half a millimetre; ICP places the pose between them.
  PoseHypothesis between = pose;
  for (int i = 0; i < kFinalIcpSteps; ++i) {
    icp_step(between, kAllPoints, parameters_.inlier_tolerance_m);
  }
  score(pose, kAllPoints, parameters_.inlier_tolerance_m);
  score(between, kAllPoints, parameters_.inlier_tolerance_m);
  if (between.score > pose.score) pose = between;
  orthonormalise(pose);
  score_finally(pose);
}

std::vector<std::size_t> PoseVerifier::explained_cells(const PoseHypothesis& pose,
                                                       double tolerance_m) const {
  const parts::PointArrays& points = part(pose).registration.points();
  const parts::View& seen = view(pose);
  const auto stride = static_cast<std::size_t>(grid_.width_px);
  std::vector<std::size_t> cells;
  for (std::uint32_t i = seen.first; i < seen.first + seen.points_n; ++i) {
    const Eigen::Vector3f p_m = pose.in_camera(points.position_m(i));
    const std::size_t cell = grid_.cell_of(p_m);
    if (cell >= grid_.z_m.size()) continue;
    // The points are about a pixel apart.
    for (const std::size_t near : {cell, cell - 1, cell + 1, cell - stride, cell + stride}) {
      const bool explained = grid_.is_open(near) &&
                             std::abs(grid_.z_m[near] - p_m.z()) <= static_cast<float>(tolerance_m);
      if (explained) cells.push_back(near);
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

}  // namespace graspd::perception
