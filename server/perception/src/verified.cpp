#include "graspd/perception/verified.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "graspd/perception/explanation.hpp"
#include "graspd/perception/hypotheses.hpp"
#include "graspd/perception/segmentation.hpp"
#include "graspd/perception/wall_bow.hpp"

namespace graspd::perception {
namespace {

/// Rounds in which the bow is found: the first one's poses are bent themselves.
constexpr int kBowRounds = 2;

/// Takes out of the scene's image what its walls bow it more, or less, than was assumed.
void straighten_further(const PoseVerifier& verifier, std::span<const PoseHypothesis> poses,
                        double assumed_m, Scene& scene, DepthGrid& grid) {
  double bow_m = assumed_m;
  for (int round = 0; round < kBowRounds; ++round) {
    const double more_m = find_wall_bow_m(grid, verifier, poses, *scene.walls);
    const double next_m = std::clamp(bow_m + more_m, 0.0, kMaxWallBow_m);
    straighten(grid, *scene.walls, next_m - bow_m);
    pack(grid);
    bow_m = next_m;
  }
  fit_normals(grid);
  if (scene.seen) straighten(*scene.seen, *scene.walls, bow_m - assumed_m);
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
Eigen::Vector3d segment_centroid_m(const DepthGrid& grid, const std::vector<std::uint32_t>& cells,
                                   const std::vector<std::uint32_t>& map, const Cloud& cloud,
                                   std::span<const Indices> segments) {
  std::vector<int> votes(segments.size() + 1, 0);
  for (const std::uint32_t cell : cells) ++votes[map[cell]];
  votes[0] = 0;
  const auto most = std::max_element(votes.begin(), votes.end());
  if (*most > 0) {
    return centroid_m(cloud, segments[static_cast<std::size_t>(most - votes.begin() - 1)]);
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t cell : cells) {
    const auto width = static_cast<std::size_t>(grid.width_px);
    sum +=
        grid.point_m(static_cast<int>(cell % width), static_cast<int>(cell / width)).cast<double>();
  }
  return sum / static_cast<double>(cells.size());
}

}  // namespace

RegistrationResult register_verified(const DepthFrame& frame, Scene& scene,
                                     std::span<const Indices> segments,
                                     std::span<const parts::Part* const> parts,
                                     const Parameters& parameters, const IsLate& is_late) {
  DepthGrid grid =
      scene.grid ? *scene.grid : make_depth_grid(frame, scene.cloud, parameters.preprocess);
  const PoseVerifier verifier(grid, parts, parameters.registration);
  RegistrationResult result;
  Explanation explained;
  for (int look = 0; look < kLooks && !is_late(); ++look) {
    HypothesesFound found =
        find_hypotheses(grid, verifier, parts, parameters.registration, is_late);
    result.hypotheses_n += static_cast<std::uint32_t>(found.compared_n);
    if (look == 0 && scene.walls) {
      straighten_further(verifier, found.poses, parameters.preprocess.wall_bow_m, scene, grid);
    }
    explain(grid, verifier, scene, std::move(found.poses), parameters.registration, is_late,
            explained);
  }
  weigh_in_bin(grid, verifier, parameters.registration, explained);

  const auto map = segment_map(grid, scene.cloud, segments);
  result.refusal = explained.refusal;
  for (const ExplainedPart& one : explained.parts) {
    RegisteredPart& part = result.parts.emplace_back();
    part.part = parts[one.pose.part];
    part.T_camera_part = one.pose.T_camera_part();
    part.evidence = evidence_of(one.pose);
    part.p_camera_segment_centroid_m =
        segment_centroid_m(grid, one.cells, map, scene.cloud, segments);
  }
  result.rejected_score_n = result.hypotheses_n - static_cast<std::uint32_t>(result.parts.size());
  return result;
}

}  // namespace graspd::perception
