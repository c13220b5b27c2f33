#include "graspd/perception/pose_hypothesis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace graspd::perception {
namespace {

constexpr std::size_t kSearchPoints = 192;
constexpr float kFirstStep_m = 0.003F;
constexpr float kLastStep_m = 0.0006F;
constexpr int kMaxSteps = 6;
constexpr int kFinalIcpSteps = 3;
constexpr std::size_t kBlock = 128;   ///< of points that are projected at once
constexpr double kIcpDamping = 0.02;  ///< of the number of points
/// A normal that agrees counts fully, one that is off by 60° only as half: normals of the image are
/// off by 10° to 20°.
constexpr float kNormalWeight = 0.5F;
/// Half of a point's weight ends at half of the tolerance: of two poses that a sparse image
/// supports alike, the closer one is right.
constexpr float kSmallError2 = 4;
constexpr float kAgreeingCosine = 0.9F;
constexpr float kOpposingCosine = 0.5F;

/// Fewer are taken for as many, as they were in the fit: small parts are not punished for that.
constexpr std::int32_t kFewestThatCount = 200;

KernelPose for_kernel(const PoseHypothesis& pose) {
  KernelPose result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.R[3 * i + j] = pose.R(i, j);
    result.t_m[i] = pose.t_m[i];
  }
  return result;
}

PointSpan span_of(const parts::PointArrays& points, std::size_t first, std::size_t count) {
  return {points.x_m.data() + first, points.y_m.data() + first, points.z_m.data() + first, count};
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

Eigen::Isometry3d PoseHypothesis::T_camera_part() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(R.cast<double>()).normalized().toRotationMatrix();
  T.translation() = t_m.cast<double>();
  return T;
}

PoseHypothesis PoseHypothesis::of(const Eigen::Isometry3d& T_camera_part, std::uint32_t part) {
  PoseHypothesis pose;
  pose.part = part;
  pose.R = T_camera_part.linear().cast<float>();
  pose.t_m = T_camera_part.translation().cast<float>();
  return pose;
}

Evidence evidence_of(const PoseHypothesis& pose) {
  const PoseCounts& counts = pose.counts;
  const double tested = std::max(1, counts.tested_n);
  const double compared = std::max(1, counts.support_n + counts.refute_n);
  Evidence evidence;
  evidence.visible_fraction = counts.support_n / tested;
  evidence.refuted_fraction = counts.refute_n / tested;
  evidence.inlier_fraction = counts.support_n / compared;
  evidence.rms_m = std::sqrt(counts.error2_sum / std::max(1.0, double(counts.support_n))) *
                   static_cast<double>(PackedDepth::kUnit_m);
  evidence.score = static_cast<double>(pose.confidence);
  return evidence;
}

const parts::View& PoseVerifier::view(const PoseHypothesis& pose) const {
  return part(pose).registration.view_from(-(pose.R.transpose() * pose.t_m));
}

SurfaceSpan PoseVerifier::seen_surface(const PoseHypothesis& pose, std::size_t most) const {
  return seen_surface(pose, view(pose), most);
}

SurfaceSpan PoseVerifier::seen_surface(const PoseHypothesis& pose, const parts::View& seen,
                                       std::size_t most) const {
  const parts::PointArrays& all = part(pose).registration.points();
  return {span_of(all, seen.first, std::min<std::size_t>(most, seen.points_n)),
          all.nx.data() + seen.first, all.ny.data() + seen.first, all.nz.data() + seen.first};
}

Eigen::Vector3f PoseVerifier::barycentre_m(const PoseHypothesis& pose) const {
  return pose.in_camera(part(pose).barycentre_m.cast<float>());
}

void PoseVerifier::set_score(PoseHypothesis& pose, const parts::View& seen, float support) const {
  const auto refuted = static_cast<float>(parameters_.refuted_weight * pose.counts.refute_n);
  pose.fit = (support - refuted) / static_cast<float>(std::max(1, pose.counts.tested_n));
  pose.score = pose.fit * seen.area_share;
}

bool PoseVerifier::score(PoseHypothesis& pose, std::size_t points_n, double tolerance_m,
                         const EarlyStop& stop) const {
  const parts::View& seen = view(pose);
  const PointSpan points = seen_surface(pose, seen, points_n).points;
  pose.counts = count_evidence(grid_.for_kernel(), for_kernel(pose), points,
                               static_cast<float>(tolerance_m), stop);
  if (static_cast<std::size_t>(pose.counts.tested_n) < points.size) return false;
  // Each supporting point counts 1 − (error / tolerance)².
  const auto tolerance = static_cast<float>(tolerance_m) / PackedDepth::kUnit_m;
  set_score(pose, seen,
            static_cast<float>(pose.counts.support_n) -
                static_cast<float>(pose.counts.error2_sum) / (tolerance * tolerance));
  return true;
}

std::optional<Refusal> PoseVerifier::score_finally(PoseHypothesis& pose) const {
  score(pose, kAllPoints, parameters_.inlier_tolerance_m);
  const float fit = pose.fit;
  const float support = weigh_support(
      grid_.for_kernel(), grid_.normals.front().data(), for_kernel(pose), seen_surface(pose),
      {static_cast<float>(parameters_.inlier_tolerance_m), kSmallError2, kNormalWeight,
       kAgreeingCosine, kOpposingCosine});
  set_score(pose, view(pose), support);
  const float leftover = leftover_share(pose);
  pose.confidence = confidence_alone(confidence_terms(pose, leftover));
  pose.fit = fit;
  const auto refused = refusal(pose, leftover);
  if (refused) pose.score = 0;
  return refused;
}

std::optional<Refusal> PoseVerifier::refusal(const PoseHypothesis& pose, float leftover) const {
  const auto by = [&](std::string_view parameter, double limit, double value) {
    return Refusal{&part(pose), parameter, limit, value};
  };
  if (pose.fit < static_cast<float>(parameters_.min_verified_score)) {
    return by("min_verified_score", parameters_.min_verified_score, pose.fit);
  }
  const float pixel_m = pose.t_m.z() / grid_.fx_px;
  const float explained_px = explained_area_m2(pose) / (pixel_m * pixel_m);
  if (explained_px < static_cast<float>(parameters_.min_explained_px)) {
    return by("min_explained_px", parameters_.min_explained_px, explained_px);
  }
  const double visible_share = double(pose.counts.support_n) / std::max(1, pose.counts.tested_n);
  if (visible_share < parameters_.min_visible_share) {
    return by("min_visible_share", parameters_.min_visible_share, visible_share);
  }
  const int unhidden_n = pose.counts.tested_n - pose.counts.hidden_n;
  const double unhidden_share = double(pose.counts.support_n) / std::max(1, unhidden_n);
  if (unhidden_share < parameters_.min_unhidden_share) {
    return by("min_unhidden_share", parameters_.min_unhidden_share, unhidden_share);
  }
  if (leftover > static_cast<float>(parameters_.max_leftover_share)) {
    return by("max_leftover_share", parameters_.max_leftover_share, leftover);
  }
  if (pose.confidence < static_cast<float>(parameters_.min_confidence)) {
    return by("min_confidence", parameters_.min_confidence, pose.confidence);
  }
  return std::nullopt;
}

ConfidenceTerms PoseVerifier::confidence_terms(const PoseHypothesis& pose, float leftover) const {
  const PoseCounts& counts = pose.counts;
  return {pose.score / view(pose).area_share,
          static_cast<float>(counts.refute_n) / static_cast<float>(std::max(1, counts.tested_n)),
          std::log(static_cast<float>(std::max(kFewestThatCount, counts.support_n))), leftover};
}

float PoseVerifier::leftover_share(const PoseHypothesis& pose) const {
  const parts::View& seen = view(pose);
  const PointSpan points =
      span_of(part(pose).registration.beyond(), seen.beyond_first, seen.beyond_n);
  const PoseCounts counts = count_evidence(grid_.for_kernel(), for_kernel(pose), points,
                                           static_cast<float>(parameters_.inlier_tolerance_m));
  return static_cast<float>(counts.support_n) / static_cast<float>(std::max(1, counts.tested_n));
}

void PoseVerifier::icp_step(PoseHypothesis& pose, std::size_t points_n, double tolerance_m) const {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const Eigen::Vector3f centre_m = barycentre_m(pose);
  // Turns in units of the part's radius: all six unknowns are alike in size.
  const auto radius_m = static_cast<float>(part(pose).diameter_m / 2);
  const NormalEquations equations = icp_equations(
      grid_.for_kernel(), for_kernel(pose), seen_surface(pose, points_n),
      {{centre_m.x(), centre_m.y(), centre_m.z()}, radius_m}, static_cast<float>(tolerance_m));
  if (equations.points_n < 6) return;
  Eigen::Matrix<double, 6, 6> A;
  for (int row = 0, k = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      A(row, column) = A(column, row) = static_cast<double>(equations.A[k++]);
    }
  }
  A.diagonal().array() += kIcpDamping * equations.points_n;
  const Vector6 step =
      A.llt().solve(Eigen::Map<const Eigen::Matrix<float, 6, 1>>(equations.b).cast<double>());
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

std::optional<Refusal> PoseVerifier::refine(PoseHypothesis& pose) const {
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
  return score_finally(pose);
}

std::vector<std::uint32_t> PoseVerifier::explained_cells(const PoseHypothesis& pose,
                                                         double tolerance_m,
                                                         CellMarks& marks) const {
  // The points are about a pixel apart.
  const std::int32_t around[] = {0, -1, 1, -grid_.width_px, grid_.width_px};
  marks.clear();
  std::vector<std::uint32_t> cells(std::size(around) * view(pose).points_n);
  cells.resize(open_cells(pose, tolerance_m, around, marks, cells.data()));
  return cells;
}

std::size_t PoseVerifier::supporting_cells(const PoseHypothesis& pose, double tolerance_m,
                                           CellMarks& marks, std::uint32_t* cells) const {
  const std::int32_t itself[] = {0};
  marks.clear();
  return open_cells(pose, tolerance_m, itself, marks, cells);
}

std::size_t PoseVerifier::open_cells(const PoseHypothesis& pose, double tolerance_m,
                                     std::span<const std::int32_t> offsets, CellMarks& marks,
                                     std::uint32_t* cells) const {
  const PackedDepth depth = grid_.for_kernel();
  const KernelPose kernel_pose = for_kernel(pose);
  const PointSpan points = seen_surface(pose).points;
  const auto most_m = static_cast<float>(tolerance_m);
  std::array<std::int32_t, kBlock> cells_of;
  std::array<float, kBlock> z_m;
  std::uint32_t* next = cells;
  for (std::size_t first = 0; first < points.size; first += kBlock) {
    const PointSpan block{points.x_m + first, points.y_m + first, points.z_m + first,
                          std::min(kBlock, points.size - first)};
    project_points(depth, kernel_pose, block, cells_of.data(), z_m.data());
    for (std::size_t i = 0; i < block.size; ++i) {
      if (cells_of[i] == 0) continue;
      for (const std::int32_t offset : offsets) {
        const auto near = static_cast<std::uint32_t>(cells_of[i] + offset);
        const bool explained = grid_.is_open(near) & (std::abs(grid_.z_m[near] - z_m[i]) <= most_m);
        // Every cell is written down and only new ones are counted: a branch would be a guess.
        *next = near;
        next += marks.add_if(explained, near) ? 1 : 0;
      }
    }
  }
  return static_cast<std::size_t>(next - cells);
}

}  // namespace graspd::perception
