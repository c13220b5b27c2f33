#include "graspd/perception/explanation.hpp"

#include <algorithm>

#include "parallel.hpp"
#include "selection.hpp"
#include "supporting_cells.hpp"

namespace graspd::perception {
namespace {

constexpr double kClaimTolerance_m = 0.01;
/// Two parts can't have their barycentres nearer than this share of the smaller diameter.
constexpr double kSamePartShare = 0.2;
/// A rough pose is refined where it is among so many best at some share of its readings. More of
/// them found hardly more parts.
constexpr int kRivals = 2;
constexpr double kRivalShare = 0.2;

/// What a candidate's area counts at least, however improbable its pose is.
constexpr float kImprobableWeight = 0.5F;

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

/// What explains most first.
void sort_by_area(const PoseVerifier& verifier, std::vector<PoseHypothesis>& poses) {
  std::stable_sort(poses.begin(), poses.end(), [&](const auto& a, const auto& b) {
    return verifier.explained_area_m2(a) > verifier.explained_area_m2(b);
  });
}

/// Refines each as if it were alone, and drops what the image or the floor refuses.
void refine_alone(const PoseVerifier& verifier, const Scene& scene,
                  const RegistrationParameters& parameters, std::vector<PoseHypothesis>& poses,
                  NearestMiss& nearest_miss) {
  struct Miss {
    float nearness = 0;
    std::optional<Refusal> refusal;
  };
  std::vector<Miss> misses(poses.size());
  parallel_for(poses.size(), [&](std::size_t i) {
    PoseHypothesis& pose = poses[i];
    const auto refusal = verifier.refine(pose);
    if (refusal) {
      misses[i] = {pose.fit, refusal};
      return;
    }
    const double below_m =
        scene.has_floor ? below_floor_m(verifier, pose, scene.T_camera_floor) : 0;
    if (below_m <= parameters.max_below_floor_m) return;
    pose.score = 0;
    misses[i] = {1 + pose.fit, Refusal{&verifier.part(pose), "max_below_floor_m",
                                       parameters.max_below_floor_m, below_m}};
  });
  for (const Miss& miss : misses) nearest_miss.add(miss.nearness, miss.refusal);
  std::erase_if(poses, [](const PoseHypothesis& pose) { return pose.score <= 0; });
}

Place place_of(const PoseVerifier& verifier, const PoseHypothesis& pose) {
  return {verifier.barycentre_m(pose),
          static_cast<float>(kSamePartShare * verifier.part(pose).diameter_m)};
}

std::vector<std::uint32_t> choose(const DepthGrid& grid, const PoseVerifier& verifier,
                                  const RegistrationParameters& parameters,
                                  const std::vector<PoseHypothesis>& poses) {
  const SupportingCells supporting(grid, verifier, poses, parameters.inlier_tolerance_m);
  std::vector<Candidate> candidates;
  candidates.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseHypothesis& pose = poses[i];
    const float pixel_m = pose.t_m.z() / grid.fx_px;
    const float weight = kImprobableWeight + (1 - kImprobableWeight) * pose.confidence;
    candidates.push_back({place_of(verifier, pose), weight * verifier.explained_area_m2(pose),
                          pixel_m * pixel_m, supporting.of(i)});
  }
  return choose_explanation(candidates, grid.size());
}

}  // namespace

void keep_promising(const DepthGrid& grid, const PoseVerifier& verifier,
                    const RegistrationParameters& parameters, std::vector<PoseHypothesis>& poses) {
  sort_by_area(verifier, poses);
  const SupportingCells supporting(grid, verifier, poses, parameters.coarse_tolerance_m);
  std::vector<std::uint8_t> rivals_n(grid.size(), 0);
  std::size_t kept_n = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto cells = supporting.of(i);
    const auto open_n =
        std::ranges::count_if(cells, [&](std::uint32_t cell) { return rivals_n[cell] < kRivals; });
    if (static_cast<double>(open_n) <= kRivalShare * static_cast<double>(cells.size())) continue;
    for (const std::uint32_t cell : cells) rivals_n[cell] += rivals_n[cell] < kRivals;
    poses[kept_n++] = poses[i];
  }
  poses.resize(kept_n);
}

void explain(DepthGrid& grid, const PoseVerifier& verifier, const Scene& scene,
             std::vector<PoseHypothesis> poses, const RegistrationParameters& parameters,
             const IsLate& is_late, Explanation& explanation) {
  NearestMiss nearest_miss;
  keep_promising(grid, verifier, parameters, poses);
  refine_alone(verifier, scene, parameters, poses, nearest_miss);
  sort_by_area(verifier, poses);

  // Once more, each among the others: what one claims hides what lies behind it.
  CellMarks marks(grid.size());
  for (const std::uint32_t i : choose(grid, verifier, parameters, poses)) {
    if (is_late()) break;
    PoseHypothesis& pose = poses[i];
    const auto refusal = verifier.refine(pose);
    nearest_miss.add(pose.fit, refusal);
    const auto is_there_already = [&](const ExplainedPart& other) {
      return is_same_place(place_of(verifier, pose), place_of(verifier, other.pose));
    };
    if (refusal || std::ranges::any_of(explanation.parts, is_there_already)) continue;
    explanation.parts.push_back({pose, verifier.explained_cells(pose, kClaimTolerance_m, marks)});
    grid.claim(explanation.parts.back().cells);
  }
  if (!explanation.refusal) explanation.refusal = nearest_miss.refusal();
}

std::vector<BinTerms> terms_in_bin(const DepthGrid& grid, const PoseVerifier& verifier,
                                   const Explanation& explanation) {
  const auto is_part = [&](std::uint32_t cell) { return grid.is_part[cell] != 0; };
  float explained_n = 0;
  for (const ExplainedPart& part : explanation.parts) {
    explained_n +=
        part.pose.confidence * static_cast<float>(std::ranges::count_if(part.cells, is_part));
  }
  const auto all_n = std::ranges::count_if(grid.is_part, [](std::uint8_t is) { return is != 0; });
  const float explained = explained_n / static_cast<float>(std::max<std::ptrdiff_t>(1, all_n));
  std::vector<BinTerms> terms;
  terms.reserve(explanation.parts.size());
  for (const ExplainedPart& part : explanation.parts) {
    terms.push_back({part.pose.confidence, explained, verifier.leftover_share(part.pose)});
  }
  return terms;
}

void weigh_in_bin(const DepthGrid& grid, const PoseVerifier& verifier,
                  const RegistrationParameters& parameters, Explanation& explanation) {
  const std::vector<BinTerms> terms = terms_in_bin(grid, verifier, explanation);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    explanation.parts[i].pose.confidence = confidence_in_bin(terms[i]);
  }
  NearestMiss nearest_miss;
  std::erase_if(explanation.parts, [&](const ExplainedPart& part) {
    const auto& [pose, _] = part;
    if (pose.confidence >= static_cast<float>(parameters.min_confidence)) return false;
    nearest_miss.add(pose.confidence, Refusal{&verifier.part(pose), "min_confidence",
                                              parameters.min_confidence, pose.confidence});
    return true;
  });
  if (nearest_miss.refusal()) explanation.refusal = nearest_miss.refusal();
}

}  // namespace graspd::perception
