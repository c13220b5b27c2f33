#include "graspd/perception/registration.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>

#include "parallel.hpp"

namespace graspd::perception {
namespace {

/// Two parts can't have their barycentres nearer than this share of the smaller diameter.
constexpr double kSamePlaceShare = 0.25;

Cloud subset(const Cloud& cloud, const Indices& indices) {
  Cloud part;
  for (const std::uint32_t i : indices) {
    part.points_m.push_back(cloud.points_m[i]);
    part.normals.push_back(cloud.normals[i]);
    part.curvatures.push_back(cloud.curvatures[i]);
  }
  return part;
}

struct SegmentResult {
  std::uint32_t hypotheses_n = 0;
  std::optional<RegisteredPart> best;  ///< by evidence, whatever its score
};

SegmentResult register_segment(const DepthFrame& frame, const Cloud& segment,
                               std::span<const parts::Part* const> parts,
                               const RegistrationMethod& method, double tolerance_m) {
  SegmentResult result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const Eigen::Isometry3d& T_camera_part : method(segment, i)) {
      ++result.hypotheses_n;
      const Evidence evidence = evaluate_pose(frame, *parts[i], T_camera_part, tolerance_m);
      if (result.best && result.best->evidence.score >= evidence.score) continue;
      result.best = {parts[i], T_camera_part, evidence,
                     principal_frame(segment.points_m).centroid_m};
    }
  }
  return result;
}

/// How far the pose reaches through the floor.
double below_floor_m(const RegisteredPart& part, const Eigen::Isometry3d& T_camera_floor) {
  const Eigen::Isometry3f T_floor_part =
      (T_camera_floor.inverse() * part.T_camera_part).cast<float>();
  float lowest_m = 0;
  for (const auto& point : part.part->surface) {
    lowest_m = std::min(lowest_m, (T_floor_part * point.position_m).z());
  }
  return -lowest_m;
}

/// The rule that forbids the pose, if one does.
std::optional<Refusal> refusal_of(const RegisteredPart& pose, const Scene& scene,
                                  const RegistrationParameters& parameters) {
  if (pose.evidence.score < parameters.min_score) {
    return Refusal{pose.part, "min_score", parameters.min_score, pose.evidence.score};
  }
  const double below_m = scene.has_floor ? below_floor_m(pose, scene.T_camera_floor) : 0;
  if (below_m > parameters.max_below_floor_m) {
    return Refusal{pose.part, "max_below_floor_m", parameters.max_below_floor_m, below_m};
  }
  return std::nullopt;
}

bool same_place(const RegisteredPart& a, const RegisteredPart& b) {
  const double reach_m = kSamePlaceShare * std::min(a.part->diameter_m, b.part->diameter_m);
  return (a.T_camera_part * a.part->barycentre_m - b.T_camera_part * b.part->barycentre_m).norm() <
         reach_m;
}

}  // namespace

PrincipalFrame principal_frame(std::span<const Eigen::Vector3f> points_m) {
  PrincipalFrame frame;
  const auto count = static_cast<double>(points_m.size());
  for (const auto& p : points_m) frame.centroid_m += p.cast<double>();
  frame.centroid_m /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points_m) {
    const Eigen::Vector3d d = p.cast<double>() - frame.centroid_m;
    covariance += d * d.transpose();
  }
  covariance /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // ascending
  frame.axes = solver.eigenvectors().rowwise().reverse();
  if (frame.axes.determinant() < 0) frame.axes.col(2) *= -1;
  frame.variances_m2 = solver.eigenvalues().reverse();
  return frame;
}

RegistrationMethod registration_method(Registration name, std::span<const parts::Part* const> parts,
                                       const RegistrationParameters& parameters) {
  switch (name) {
    case Registration::kPcaIcp:
      return pca_icp(parts, parameters);
    case Registration::kSacIaIcp:
      return sac_ia_icp(parts, parameters);
    case Registration::kNdtIcp:
      return ndt_icp(parts, parameters);
    case Registration::kVerified:
    case Registration::kServerDefault:
      break;
  }
  throw std::invalid_argument(
      fmt::format("registration_method: '{}' is not in this build", name_of(name)));
}

RegistrationResult register_segments(const DepthFrame& frame, const Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const RegistrationParameters& parameters,
                                     const IsLate& is_late) {
  const RegistrationMethod method = registration_method(parameters.method, parts, parameters);
  // Each segment has its own slot, so the threads' order does not show in the answer.
  std::vector<SegmentResult> found(segments.size());
  Deadline deadline(is_late);
  parallel_for(segments.size(), [&](std::size_t i) {
    if (deadline.has_passed()) return;
    found[i] = register_segment(frame, subset(scene.cloud, segments[i]), parts, method,
                                parameters.inlier_tolerance_m);
  });

  RegistrationResult result;
  double best_refused = -1;
  for (const auto& [hypotheses_n, best] : found) {
    result.hypotheses_n += hypotheses_n;
    if (!best) continue;
    const auto refusal = refusal_of(*best, scene, parameters);
    if (!refusal) {
      result.parts.push_back(*best);
    } else if (best->evidence.score > best_refused) {
      best_refused = best->evidence.score;
      result.refusal = refusal;
    }
  }
  std::stable_sort(result.parts.begin(), result.parts.end(), [](const auto& a, const auto& b) {
    return a.evidence.score > b.evidence.score;
  });
  for (auto candidate = result.parts.begin(); candidate != result.parts.end();) {
    const bool taken = std::any_of(result.parts.begin(), candidate, [&](const auto& better) {
      return same_place(better, *candidate);
    });
    candidate = taken ? result.parts.erase(candidate) : candidate + 1;
  }
  result.rejected_score_n = result.hypotheses_n - static_cast<std::uint32_t>(result.parts.size());
  return result;
}

}  // namespace graspd::perception
