#include "graspd/perception/explanation.hpp"

#include <algorithm>

namespace graspd::perception {
namespace {

constexpr float kClaimTolerance_m = 0.01F;
/// Two parts can't have their barycentres nearer than this share of the smaller diameter.
constexpr double kSamePartShare = 0.2;
/// By how much a pose may explain more once it has been refined.
constexpr float kExpectedGain = 1.15F;

/// A pose's place in the queue. What it explains can only fall while others claim pixels, so that
/// only the first in the queue must be up to date: the greedy is a lazy one.
struct Entry {
  float area_m2;  ///< that the pose explains: a small part fits a piece of anything
  std::size_t pose;
  std::size_t scored_at = 0;   ///< after so many acceptances
  std::size_t refined_at = 0;  ///< likewise
  bool is_refined = false;
};

bool comes_later(const Entry& a, const Entry& b) {
  return a.area_m2 != b.area_m2 ? a.area_m2 < b.area_m2 : a.pose > b.pose;
}

class Queue {
 public:
  bool empty() const { return entries_.empty(); }
  void push(const Entry& entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end(), comes_later);
  }
  Entry pop() {
    std::pop_heap(entries_.begin(), entries_.end(), comes_later);
    const Entry entry = entries_.back();
    entries_.pop_back();
    return entry;
  }

 private:
  std::vector<Entry> entries_;
};

/// How far the pose reaches through the floor: its vertices, so that no sample between them is
/// needed.
double below_floor_m(const PoseVerifier& verifier, const PoseHypothesis& pose,
                     const Eigen::Isometry3d& T_camera_floor) {
  const Eigen::Isometry3f T_floor_camera = T_camera_floor.inverse().cast<float>();
  float lowest_m = 0;
  for (const auto& vertex_m : verifier.part(pose).mesh.vertices_m) {
    lowest_m = std::min(lowest_m, (T_floor_camera * pose.in_camera(vertex_m)).z());
  }
  return static_cast<double>(-lowest_m);
}

/// Keeps the refusal of the pose that came nearest to being accepted.
class NearestMiss {
 public:
  /// \param nearness the pose's fit, or more where it broke no rule but the last.
  void add(float nearness, const std::optional<Refusal>& refusal) {
    if (!refusal || (refusal_ && nearness <= nearness_)) return;
    nearness_ = nearness;
    refusal_ = refusal;
  }
  const std::optional<Refusal>& refusal() const { return refusal_; }

 private:
  float nearness_ = 0;
  std::optional<Refusal> refusal_;
};

bool is_same_part(const PoseVerifier& verifier, const PoseHypothesis& a, const PoseHypothesis& b) {
  const double reach_m =
      kSamePartShare * std::min(verifier.part(a).diameter_m, verifier.part(b).diameter_m);
  const float distance_m = (verifier.barycentre_m(a) - verifier.barycentre_m(b)).norm();
  return static_cast<double>(distance_m) < reach_m;
}

}  // namespace

Explanation explain(DepthGrid& grid, const PoseVerifier& verifier, const Scene& scene,
                    std::vector<PoseHypothesis> poses, const RegistrationParameters& parameters,
                    const IsLate& is_late) {
  const auto enqueue = [&](Queue& queue, Entry entry) {
    const PoseHypothesis& pose = poses[entry.pose];
    const auto least = static_cast<float>(parameters.min_coarse_score);
    if (entry.is_refined ? pose.score <= 0 : pose.fit < least) return;
    entry.area_m2 = verifier.explained_area_m2(pose) * (entry.is_refined ? 1 : kExpectedGain);
    queue.push(entry);
  };
  Queue queue;
  for (std::size_t i = 0; i < poses.size(); ++i) enqueue(queue, {0, i});

  std::vector<ExplainedPart> accepted;
  NearestMiss nearest_miss;
  while (!queue.empty() && !is_late()) {
    Entry entry = queue.pop();
    PoseHypothesis& pose = poses[entry.pose];
    const std::size_t now = accepted.size();
    if (entry.scored_at != now) {
      const float before = pose.score;
      if (entry.is_refined) {
        const auto refusal = verifier.score_finally(pose);
        nearest_miss.add(pose.fit, refusal);
      } else {
        verifier.score(pose, PoseVerifier::kCoarsePoints, parameters.inlier_tolerance_m);
      }
      entry.scored_at = now;
      if (pose.score == before) entry.refined_at = now;  // nothing of it was claimed
      enqueue(queue, entry);
    } else if (!entry.is_refined || entry.refined_at != now) {
      const auto refusal = verifier.refine(pose);
      nearest_miss.add(pose.fit, refusal);
      entry.is_refined = true;
      entry.refined_at = now;
      enqueue(queue, entry);
    } else if (std::none_of(accepted.begin(), accepted.end(), [&](const ExplainedPart& other) {
                 return is_same_part(verifier, pose, other.pose);
               })) {
      const double below_m =
          scene.has_floor ? below_floor_m(verifier, pose, scene.T_camera_floor) : 0;
      if (below_m > parameters.max_below_floor_m) {
        nearest_miss.add(1 + pose.fit, Refusal{&verifier.part(pose), "max_below_floor_m",
                                               parameters.max_below_floor_m, below_m});
        continue;
      }
      accepted.push_back({pose, verifier.explained_cells(pose, kClaimTolerance_m)});
      grid.claim(accepted.back().cells);
    }
  }
  return {std::move(accepted), nearest_miss.refusal()};
}

}  // namespace graspd::perception
