#include "graspd/perception/displacement.hpp"

#include <algorithm>

#include "graspd/perception/pose_hypothesis.hpp"

namespace graspd::perception {
namespace {

/// Chosen on tuning frames: none of 317 objects that lay still fails, all of 45 do that moved by
/// twice the threshold, 44 of 45 that moved by one and a half.
/// Of what the part would show were it alone: so much less may be seen than last time, for noise.
constexpr double kMaxFading = 0.1;
/// What the camera may see through: at the outline, half a pixel.
constexpr double kMaxRefuted = 0.13;
/// By so much more of the view another place must explain.
constexpr float kBetterElsewhere = 0.03F;
/// A picked object is still there where so much of what was seen of it is.
constexpr double kStillThere = 0.6;

bool has_moved(const PoseVerifier& verifier, const PoseHypothesis& pose, float threshold_m,
               double tolerance_m) {
  for (int direction = 0; direction < 6; ++direction) {
    PoseHypothesis elsewhere = pose;
    elsewhere.t_m[direction / 2] += direction % 2 == 0 ? threshold_m : -threshold_m;
    verifier.score(elsewhere, PoseVerifier::kAllPoints, tolerance_m);
    if (elsewhere.fit > pose.fit + kBetterElsewhere) return true;
  }
  return false;
}

}  // namespace

std::optional<std::vector<LastObject>> unchanged_objects(
    const LastPlan& last_plan, std::span<const Eigen::Vector3d> centroids_base_m,
    const DisplacementParameters& parameters) {
  const auto is_seen = [&](const LastObject& object) {
    return std::any_of(centroids_base_m.begin(), centroids_base_m.end(), [&](const auto& centroid) {
      return (centroid - object.p_base_segment_centroid_m).norm() <= parameters.threshold_m;
    });
  };
  std::vector<LastObject> standing;
  for (const LastObject& object : last_plan.objects) {
    const bool picked = object.id == last_plan.picked_object_id;
    if (is_seen(object) == picked) return std::nullopt;
    if (!picked) standing.push_back(object);
  }
  if (standing.empty()) return std::nullopt;
  return standing;
}

std::optional<std::vector<StandingObject>> standing_objects(const LastPlan& last_plan,
                                                            const parts::Catalogue& catalogue,
                                                            const DepthGrid& grid,
                                                            const Eigen::Isometry3d& T_camera_base,
                                                            const Parameters& parameters) {
  const double tolerance_m = parameters.registration.inlier_tolerance_m;
  const auto threshold_m = static_cast<float>(parameters.displacement.threshold_m);
  std::vector<StandingObject> standing;
  for (const LastObject& object : last_plan.objects) {
    const parts::Part* const part = catalogue.find(object.part_id);
    const PoseVerifier verifier(grid, {&part, 1}, parameters.registration);
    PoseHypothesis pose = PoseHypothesis::of(T_camera_base * object.T_base_part);
    verifier.score(pose, PoseVerifier::kAllPoints, tolerance_m);
    Evidence evidence = evidence_of(pose);
    // As probable as it was when it was found: nothing moved.
    evidence.score = std::clamp(object.score, 0.0, 1.0);
    if (object.id == last_plan.picked_object_id) {
      if (evidence.visible_fraction > kStillThere * object.visible_fraction) return std::nullopt;
      continue;
    }
    if (evidence.visible_fraction < object.visible_fraction - kMaxFading ||
        evidence.refuted_fraction > kMaxRefuted ||
        has_moved(verifier, pose, threshold_m, tolerance_m)) {
      return std::nullopt;
    }
    standing.push_back({object, evidence});
  }
  if (standing.empty()) return std::nullopt;
  return standing;
}

}  // namespace graspd::perception
