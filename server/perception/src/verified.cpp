#include "graspd/perception/verified.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "graspd/perception/depth_grid.hpp"
#include "graspd/perception/pose_hypothesis.hpp"

namespace graspd::perception {
namespace {

using Hypotheses = std::vector<PoseHypothesis>;

/// A reading that may lie on a part.
struct Seed {
  Eigen::Vector3f p_m;
  Eigen::Vector3f normal;
};

constexpr int kSeedReach_px = 2;
constexpr float kSeedStep_m = 0.006F;  ///< within the reach: still the same surface
constexpr int kSeedMinCells = 13;      ///< of the 25 within reach
constexpr float kSeedMinFacing = 0.25F;

/// A hypothesis is dropped after 16 points where fewer support or more refute it.
constexpr EarlyStop kEarlyStop{4, 4};
constexpr std::size_t kCoarsePoints = 64;
constexpr int kCoarseIcpSteps = 6;
constexpr double kCoarseIcpTolerance_m = 0.012;

constexpr float kSamePlace_m = 0.01F;  ///< of barycentres: poses that compete
constexpr float kClaimTolerance_m = 0.01F;
/// Two parts can't have their barycentres nearer than this share of the smaller diameter.
constexpr double kSamePartShare = 0.2;

int same_surface_n(const DepthGrid& grid, int u, int v) {
  const float z_m = grid.z_m[grid.index(u, v)];
  int count = 0;
  for (int y = v - kSeedReach_px; y <= v + kSeedReach_px; ++y) {
    for (int x = u - kSeedReach_px; x <= u + kSeedReach_px; ++x) {
      const float there_m = grid.z_m[grid.index(x, y)];
      count += there_m > 0 && std::abs(there_m - z_m) < kSeedStep_m;
    }
  }
  return count;
}

/// The reading in the middle of most surface, for each square of the grid.
std::vector<Seed> choose_seeds(const DepthGrid& grid, double spacing_m) {
  std::vector<float> depths_m;
  for (std::size_t i = 0; i < grid.z_m.size(); ++i) {
    if (grid.is_part[i] != 0) depths_m.push_back(grid.z_m[i]);
  }
  if (depths_m.empty()) return {};
  const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
  std::nth_element(depths_m.begin(), middle, depths_m.end());
  const int side =
      std::max(1, static_cast<int>(std::lround(spacing_m / static_cast<double>(*middle) *
                                               static_cast<double>(grid.fx_px))));
  const int first = 1 + kSeedReach_px;
  std::vector<Seed> seeds;
  for (int v0 = first; v0 < grid.height_px - first; v0 += side) {
    for (int u0 = first; u0 < grid.width_px - first; u0 += side) {
      int best_n = kSeedMinCells - 1;
      std::optional<Seed> best;
      for (int v = v0; v < std::min(v0 + side, grid.height_px - first); ++v) {
        for (int u = u0; u < std::min(u0 + side, grid.width_px - first); ++u) {
          const std::size_t i = grid.index(u, v);
          if (grid.is_part[i] == 0 || !grid.is_open(i) || grid.normals[i].isZero()) continue;
          const Seed seed{grid.point_m(u, v), grid.normals[i]};
          if (-seed.normal.dot(seed.p_m) < kSeedMinFacing * seed.p_m.norm()) continue;
          const int count = same_surface_n(grid, u, v);
          if (count <= best_n) continue;
          best_n = count;
          best = seed;
        }
      }
      if (best) seeds.push_back(*best);
    }
  }
  return seeds;
}

void sort_best_first(Hypotheses& poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
}

/// The rotations whose z axis is `normal`, in equal steps.
std::vector<Eigen::Matrix3f> turns_about(const Eigen::Vector3f& normal, int steps_n) {
  Eigen::Matrix3f axes;
  axes << normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal()), normal;
  std::vector<Eigen::Matrix3f> turns;
  for (int k = 0; k < steps_n; ++k) {
    const auto angle_rad = static_cast<float>(2 * M_PI * k / steps_n);
    turns.push_back(axes *
                    Eigen::AngleAxisf(angle_rad, Eigen::Vector3f::UnitZ()).toRotationMatrix());
  }
  return turns;
}

struct Proposals {
  std::uint32_t tried_n = 0;
  Hypotheses poses;
};

/// The best poses that lay some anchor of the part on the seed.
Proposals propose(const PoseVerifier& verifier, const Seed& seed, const parts::Part& part,
                  std::uint32_t part_index, const RegistrationParameters& parameters) {
  Proposals result;
  const auto turns = turns_about(seed.normal, parameters.turns_n);
  for (const parts::SurfacePoint& anchor : part.registration.anchors()) {
    Eigen::Matrix3f axes;
    axes << anchor.normal.unitOrthogonal(), anchor.normal.cross(anchor.normal.unitOrthogonal()),
        anchor.normal;
    for (const Eigen::Matrix3f& turned : turns) {
      PoseHypothesis pose;
      pose.part = part_index;
      pose.R.noalias() = turned * axes.transpose();
      pose.t_m = seed.p_m - pose.R * anchor.position_m;
      ++result.tried_n;
      if (!verifier.score(pose, kCoarsePoints, parameters.coarse_tolerance_m, kEarlyStop)) continue;
      if (pose.score >= parameters.min_coarse_score) result.poses.push_back(pose);
    }
  }
  sort_best_first(result.poses);
  const auto most = static_cast<std::size_t>(parameters.hypotheses_per_seed_n);
  if (result.poses.size() > most) result.poses.resize(most);
  return result;
}

/// Of poses that are nearly the same the best, and of each place only the best few.
void keep_distinct(const PoseVerifier& verifier, Hypotheses& poses, int per_place_n, float same_m,
                   float same_rad) {
  sort_best_first(poses);
  const float same_trace = 1 + 2 * std::cos(same_rad);
  // Kept poses by the cell of their barycentre; what is near lies in the same or the next cell.
  std::map<std::array<int, 3>, std::vector<std::size_t>> by_place;
  std::vector<Eigen::Vector3f> places;
  Hypotheses kept;
  for (const PoseHypothesis& pose : poses) {
    const Eigen::Vector3f place = verifier.barycentre_m(pose);
    const Eigen::Array3i cell = (place.array() / kSamePlace_m).floor().cast<int>();
    int near_n = 0;
    bool known = false;
    for (int k = 0; k < 27 && !known; ++k) {
      const auto found =
          by_place.find({cell.x() + k % 3 - 1, cell.y() + k / 3 % 3 - 1, cell.z() + k / 9 - 1});
      if (found == by_place.end()) continue;
      for (const std::size_t i : found->second) {
        const float distance2 = (places[i] - place).squaredNorm();
        near_n += distance2 < kSamePlace_m * kSamePlace_m;
        known = known || (kept[i].part == pose.part && distance2 < same_m * same_m &&
                          (kept[i].R.transpose() * pose.R).trace() > same_trace);
      }
    }
    if (known || near_n >= per_place_n) continue;
    by_place[{cell.x(), cell.y(), cell.z()}].push_back(kept.size());
    places.push_back(place);
    kept.push_back(pose);
  }
  poses = std::move(kept);
}

/// Hypotheses from all seeds, made better by ICP, with their final scores.
Hypotheses find_hypotheses(const DepthGrid& grid, const PoseVerifier& verifier,
                           std::span<const parts::Part* const> parts,
                           const RegistrationParameters& parameters, std::uint32_t& tried_n) {
  const std::vector<Seed> seeds = choose_seeds(grid, parameters.seed_spacing_m);
  // Each seed and part has its own slot, so the threads' order does not show in the answer.
  std::vector<Proposals> proposed(seeds.size() * parts.size());
  tbb::parallel_for(std::size_t{0}, proposed.size(), [&](std::size_t i) {
    const std::size_t part = i % parts.size();
    proposed[i] = propose(verifier, seeds[i / parts.size()], *parts[part],
                          static_cast<std::uint32_t>(part), parameters);
  });
  Hypotheses poses;
  for (const Proposals& some : proposed) {
    tried_n += some.tried_n;
    poses.insert(poses.end(), some.poses.begin(), some.poses.end());
  }
  keep_distinct(verifier, poses, parameters.coarse_per_place_n, 0.006F, 0.25F);

  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    for (int k = 0; k < kCoarseIcpSteps; ++k) {
      const bool early = k < kCoarseIcpSteps / 2;
      verifier.icp_step(poses[i], kCoarsePoints,
                        early ? kCoarseIcpTolerance_m : parameters.coarse_tolerance_m);
    }
    verifier.score(poses[i], kCoarsePoints, parameters.inlier_tolerance_m);
  });
  std::erase_if(poses, [&](const auto& pose) { return pose.score < parameters.min_coarse_score; });
  keep_distinct(verifier, poses, parameters.fine_per_place_n, 0.004F, 0.15F);

  tbb::parallel_for(std::size_t{0}, poses.size(),
                    [&](std::size_t i) { verifier.refine(poses[i]); });
  return poses;
}

/// How far the pose reaches through the floor.
double below_floor_m(const PoseVerifier& verifier, const PoseHypothesis& pose,
                     const Eigen::Isometry3d& T_camera_floor) {
  const Eigen::Isometry3f T_floor_camera = T_camera_floor.inverse().cast<float>();
  float lowest_m = 0;
  for (const auto& vertex_m : verifier.part(pose).mesh.vertices_m) {
    lowest_m = std::min(lowest_m, (T_floor_camera * pose.in_camera(vertex_m)).z());
  }
  return static_cast<double>(-lowest_m);
}

struct Accepted {
  PoseHypothesis pose;
  std::vector<std::size_t> cells;  ///< that it explains
};

/// Accepts the pose that explains most, takes that out of the image, and so on. Greedy, and lazy: a
/// score can only fall while pixels are claimed, so only the one on top is computed again.
std::vector<Accepted> explain(DepthGrid& grid, const PoseVerifier& verifier, const Scene& scene,
                              Hypotheses poses, const RegistrationParameters& parameters) {
  struct Entry {
    float area_m2;  ///< that the pose explains: a small part fits a piece of anything
    std::size_t pose;
    std::size_t scored_at, refined_at;  ///< after so many acceptances
  };
  const auto worse = [](const Entry& a, const Entry& b) {
    return a.area_m2 != b.area_m2 ? a.area_m2 < b.area_m2 : a.pose > b.pose;
  };
  std::vector<Entry> queue;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    queue.push_back({verifier.explained_area_m2(poses[i]), i, 0, 0});
  }
  std::make_heap(queue.begin(), queue.end(), worse);

  std::vector<Accepted> accepted;
  while (!queue.empty()) {
    std::pop_heap(queue.begin(), queue.end(), worse);
    Entry& entry = queue.back();
    PoseHypothesis& pose = poses[entry.pose];
    const std::size_t now = accepted.size();
    if (pose.score < parameters.min_verified_score) {
      queue.pop_back();
      continue;
    }
    if (entry.scored_at != now || entry.refined_at != now) {
      if (entry.scored_at != now) {
        const float before = pose.score;
        verifier.score_finally(pose);
        entry.scored_at = now;
        if (pose.score == before) entry.refined_at = now;  // nothing of it was claimed
      } else {
        verifier.refine(pose);
        entry.refined_at = now;
      }
      entry.area_m2 = verifier.explained_area_m2(pose);
      std::push_heap(queue.begin(), queue.end(), worse);
      continue;
    }
    queue.pop_back();
    const bool same = std::any_of(accepted.begin(), accepted.end(), [&](const Accepted& other) {
      const double reach_m = kSamePartShare * std::min(verifier.part(pose).diameter_m,
                                                       verifier.part(other.pose).diameter_m);
      return static_cast<double>(
                 (verifier.barycentre_m(pose) - verifier.barycentre_m(other.pose)).norm()) <
             reach_m;
    });
    if (same) continue;
    if (scene.has_floor &&
        below_floor_m(verifier, pose, scene.T_camera_floor) > parameters.max_below_floor_m) {
      continue;
    }
    accepted.push_back({pose, verifier.explained_cells(pose, kClaimTolerance_m)});
    grid.claim(accepted.back().cells);
  }
  return accepted;
}

/// The segment at each cell of the grid, from 1; 0 for none.
std::vector<std::uint32_t> segment_map(const DepthGrid& grid, const Cloud& cloud,
                                       std::span<const Indices> segments) {
  std::vector<std::uint32_t> map(grid.z_m.size() + 1, 0);
  for (std::uint32_t s = 0; s < segments.size(); ++s) {
    for (const std::uint32_t i : segments[s]) map[grid.cell_of(cloud.points_m[i])] = s + 1;
  }
  map.back() = 0;  // what projects beyond the grid
  return map;
}

/// The centroid of the segment that most of the part's cells lie in; of the cells themselves where
/// that is none.
Eigen::Vector3d segment_centroid_m(const DepthGrid& grid, const std::vector<std::size_t>& cells,
                                   const std::vector<std::uint32_t>& map, const Cloud& cloud,
                                   std::span<const Indices> segments) {
  std::vector<int> votes(segments.size() + 1, 0);
  for (const std::size_t cell : cells) ++votes[map[cell]];
  votes[0] = 0;
  const auto most = std::max_element(votes.begin(), votes.end());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (*most > 0) {
    const Indices& segment = segments[static_cast<std::size_t>(most - votes.begin() - 1)];
    for (const std::uint32_t i : segment) sum += cloud.points_m[i].cast<double>();
    return sum / static_cast<double>(segment.size());
  }
  for (const std::size_t cell : cells) {
    const auto width = static_cast<std::size_t>(grid.width_px);
    sum +=
        grid.point_m(static_cast<int>(cell % width), static_cast<int>(cell / width)).cast<double>();
  }
  return sum / static_cast<double>(cells.size());
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
  evidence.score = std::clamp(static_cast<double>(pose.score), 0.0, 1.0);
  return evidence;
}

}  // namespace

RegistrationResult register_verified(const DepthFrame& frame, const Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const Parameters& parameters) {
  DepthGrid grid = make_depth_grid(frame, scene.cloud, parameters.preprocess);
  const PoseVerifier verifier(grid, parts, parameters.registration);
  RegistrationResult result;
  Hypotheses poses =
      find_hypotheses(grid, verifier, parts, parameters.registration, result.hypotheses_n);
  const std::vector<Accepted> accepted =
      explain(grid, verifier, scene, std::move(poses), parameters.registration);

  const auto map = segment_map(grid, scene.cloud, segments);
  for (const Accepted& one : accepted) {
    RegisteredPart& part = result.parts.emplace_back();
    part.part = parts[one.pose.part];
    part.T_camera_part.linear() =
        Eigen::Quaterniond(one.pose.R.cast<double>()).normalized().toRotationMatrix();
    part.T_camera_part.translation() = one.pose.t_m.cast<double>();
    part.evidence = evidence_of(one.pose);
    part.p_camera_segment_centroid_m =
        segment_centroid_m(grid, one.cells, map, scene.cloud, segments);
  }
  result.rejected_score_n = result.hypotheses_n - static_cast<std::uint32_t>(result.parts.size());
  return result;
}

}  // namespace graspd::perception
