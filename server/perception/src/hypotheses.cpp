#include "graspd/perception/hypotheses.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "graspd/perception/template_kernel.hpp"
#include "parallel.hpp"

namespace graspd::perception {
namespace {

using parts::PoseTemplates;
using Poses = std::vector<PoseHypothesis>;

/// A reading that may lie on a part.
struct Seed {
  Eigen::Vector3f p_m;
  Eigen::Vector3f normal;  ///< 0 where there is too little surface to have one
};

constexpr int kSeedReach_px = 2;
constexpr float kSeedStep_m = 0.006F;  ///< within the reach: still the same surface
constexpr int kSeedMinCells = 8;       ///< of the 25 within reach
constexpr int kNormalMinCells = 15;    ///< fewer are a strip, whose normal means nothing
constexpr float kSeedMinFacing = 0.25F;

/// A hypothesis is dropped after 16 points where fewer support or more refute it.
constexpr EarlyStop kEarlyStop{4, 5};
constexpr int kCoarseIcpSteps = 6;
constexpr double kCoarseIcpTolerance_m = 0.012;
constexpr float kSamePlace_m = 0.01F;  ///< of barycentres: poses that compete

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

/// The pixels that a length has at the depth of most readings.
int in_pixels(const DepthGrid& grid, double length_m) {
  std::vector<float> depths_m;
  for (std::size_t i = 0; i < grid.z_m.size(); ++i) {
    if (grid.is_part[i] != 0) depths_m.push_back(grid.z_m[i]);
  }
  if (depths_m.empty()) return 1;
  const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
  std::nth_element(depths_m.begin(), middle, depths_m.end());
  const double pixels = length_m / static_cast<double>(*middle) * static_cast<double>(grid.fx_px);
  return std::max(1, static_cast<int>(std::lround(pixels)));
}

/// The best seed of a square.
std::optional<Seed> choose_seed(const DepthGrid& grid, int u_first, int v_first, int u_end,
                                int v_end) {
  int best_n = kSeedMinCells - 1;
  std::optional<Seed> best;
  for (int v = v_first; v < v_end; ++v) {
    for (int u = u_first; u < u_end; ++u) {
      const std::size_t i = grid.index(u, v);
      if (!grid.can_support(i)) continue;
      const int count = same_surface_n(grid, u, v);
      if (count <= best_n) continue;
      Seed seed{grid.point_m(u, v), grid.normals[i]};
      if (count < kNormalMinCells) seed.normal.setZero();
      const bool faces = -seed.normal.dot(seed.p_m) >= kSeedMinFacing * seed.p_m.norm();
      if (!faces && !seed.normal.isZero()) continue;
      best_n = count;
      best = seed;
    }
  }
  return best;
}

/// The squares lie about the principal point, wherever the grid begins.
std::vector<Seed> choose_seeds(const DepthGrid& grid, double spacing_m) {
  const int side = in_pixels(grid, spacing_m);
  const int first = 1 + kSeedReach_px;
  const auto first_square = [&](float middle_px) {
    const int beyond = (first - static_cast<int>(std::lround(middle_px))) % side;
    return first - (beyond < 0 ? beyond + side : beyond);
  };
  const int u_end = grid.width_px - first;
  const int v_end = grid.height_px - first;
  const int u_first = first_square(grid.cx_px);
  const int v_first = first_square(grid.cy_px);
  const auto squares_n = [&](int from, int end) {
    return static_cast<std::size_t>(std::max(0, (end - from + side - 1) / side));
  };
  const std::size_t columns_n = squares_n(u_first, u_end);
  std::vector<std::optional<Seed>> of_squares(columns_n * squares_n(v_first, v_end));
  parallel_for(of_squares.size(), [&](std::size_t i) {
    const int u = u_first + static_cast<int>(i % columns_n) * side;
    const int v = v_first + static_cast<int>(i / columns_n) * side;
    of_squares[i] = choose_seed(grid, std::max(u, first), std::max(v, first),
                                std::min(u + side, u_end), std::min(v + side, v_end));
  });
  std::vector<Seed> seeds;
  for (const auto& seed : of_squares) {
    if (seed) seeds.push_back(*seed);
  }
  return seeds;
}

/// Unit vectors to the places of a ring.
std::array<Eigen::Vector2f, PoseTemplates::kTurns> ring_directions() {
  std::array<Eigen::Vector2f, PoseTemplates::kTurns> directions;
  for (int k = 0; k < PoseTemplates::kTurns; ++k) {
    const float angle_rad =
        2 * std::numbers::pi_v<float> * static_cast<float>(k) / PoseTemplates::kTurns;
    directions[static_cast<std::size_t>(k)] = {std::cos(angle_rad), std::sin(angle_rad)};
  }
  return directions;
}
const std::array<Eigen::Vector2f, PoseTemplates::kTurns> kRing = ring_directions();

/// The image around a seed, and the frames in which the templates' turns stand there.
class SeedView {
 public:
  SeedView(const DepthGrid& grid, const Seed& seed)
      : R_camera_ray_(Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitZ(), seed.p_m)
                          .toRotationMatrix()),
        grid_(grid),
        seed_(seed) {}

  SampledReading sample(float diameter_m) const {
    SampledReading reading{};
    const float z_m = seed_.p_m.z();
    const Eigen::Vector2f pixel(seed_.p_m.x() / z_m * grid_.fx_px + grid_.cx_px,
                                seed_.p_m.y() / z_m * grid_.fy_px + grid_.cy_px);
    for (int i = 0; i < SampledReading::kSamples; ++i) {
      const float radius_px =
          PoseTemplates::kRadii[static_cast<std::size_t>(i % PoseTemplates::kRings)] * diameter_m /
          z_m * grid_.fx_px;
      const Eigen::Vector2f at =
          pixel + radius_px * kRing[static_cast<std::size_t>(i / PoseTemplates::kRings)];
      const auto u = static_cast<int>(std::lround(at.x()));
      const auto v = static_cast<int>(std::lround(at.y()));
      if (!grid_.contains(u, v)) continue;
      const float there_m = grid_.z_m[grid_.index(u, v)];
      if (there_m <= 0) continue;
      const float behind = (there_m - z_m) / (PoseTemplates::kUnit * diameter_m);
      reading.has_reading |= std::uint64_t{1} << i;
      reading.depths[i] = reading.depths[i + SampledReading::kSamples] =
          static_cast<std::int8_t>(std::clamp(behind, -127.0F, 127.0F));
    }
    const auto [sine, cosine, turns] =
        PoseTemplates::polar(R_camera_ray_.transpose() * seed_.normal);
    reading.normal_sine = sine;
    reading.normal_cosine = cosine;
    reading.normal_turns = turns;
    return reading;
  }

  /// The pose that lays a template's anchor on the seed.
  void lay(const PoseTemplates& templates, const TemplateMatch& match, PoseHypothesis& pose) const {
    const Eigen::Vector2f& turned = kRing[match.turn()];
    Eigen::Matrix3f R_ray_view;
    R_ray_view << turned.x(), -turned.y(), 0, turned.y(), turned.x(), 0, 0, 0, 1;
    pose.R = R_camera_ray_ * R_ray_view * templates.R_view_part[templates.views[match.index()]];
    pose.t_m = seed_.p_m - pose.R * templates.anchors_m[match.index()];
  }

 private:
  Eigen::Matrix3f R_camera_ray_;
  const DepthGrid& grid_;
  const Seed& seed_;
};

void sort_best_first(Poses& poses) {
  std::sort(poses.begin(), poses.end(),
            [](const auto& a, const auto& b) { return a.score > b.score; });
}

/// Of one thread.
struct WorkingMemory {
  TemplateMatches matches;
  Poses poses;
};

struct Proposed {
  std::size_t poses_n = 0;
  std::uint64_t compared_n = 0;
};

/// \param best the best poses are written there, as many as it takes.
Proposed propose(const DepthGrid& grid, const PoseVerifier& verifier, const Seed& seed,
                 const parts::Part& part, std::uint32_t part_index,
                 const RegistrationParameters& parameters, WorkingMemory& memory,
                 std::span<PoseHypothesis> best) {
  const PoseTemplates& templates = part.registration.templates();
  const auto diameter_m = static_cast<float>(part.diameter_m);
  const double tolerance =
      parameters.coarse_tolerance_m / (part.diameter_m * double{PoseTemplates::kUnit});
  TemplateLimits limits;
  limits.tolerance = static_cast<std::int8_t>(std::clamp(std::lround(tolerance), 1L, 60L));
  if (!seed.normal.isZero()) {
    limits.min_cosine = static_cast<float>(std::cos(parameters.normal_tolerance_rad));
  }
  limits.most_n = static_cast<std::size_t>(parameters.templates_per_seed_n);
  const SeedView view(grid, seed);
  match_templates(templates, view.sample(diameter_m), limits, memory.matches);

  memory.poses.clear();
  for (std::size_t i = 0; i < memory.matches.kept_n; ++i) {
    PoseHypothesis pose;
    pose.part = part_index;
    view.lay(templates, memory.matches.kept[i], pose);
    if (!verifier.score(pose, PoseVerifier::kCoarsePoints, parameters.coarse_tolerance_m,
                        kEarlyStop))
      continue;
    if (pose.fit >= static_cast<float>(parameters.min_coarse_score)) memory.poses.push_back(pose);
  }
  sort_best_first(memory.poses);
  const std::size_t poses_n = std::min(best.size(), memory.poses.size());
  std::copy_n(memory.poses.begin(), poses_n, best.begin());
  return {poses_n, memory.matches.compared_n};
}

/// Barycentres, found by place: cubes at least as wide as a place, with a list of what lies in
/// each.
class Places {
 public:
  explicit Places(const std::vector<Eigen::Vector3f>& all_m) {
    for (const Eigen::Vector3f& place_m : all_m) box_.extend(place_m);
    if (all_m.empty()) return;
    side_m_ = std::max(kSamePlace_m, box_.sizes().maxCoeff() / kMostCubes);
    size_ = cell_of(box_.max()) + 1;
    first_.assign(static_cast<std::size_t>(size_.prod()), kNone);
    next_.reserve(all_m.size());
    places_m_.reserve(all_m.size());
  }

  void add(const Eigen::Vector3f& place_m) {
    std::int32_t& first = first_[index(cell_of(place_m))];
    next_.push_back(first);
    first = static_cast<std::int32_t>(places_m_.size());
    places_m_.push_back(place_m);
  }

  /// Whether `is_it(i, distance²)` of any of the added places within kSamePlace_m.
  template <class IsIt>
  bool any_near(const Eigen::Vector3f& place_m, const IsIt& is_it) const {
    const Eigen::Array3i first = (cell_of(place_m) - 1).max(0);
    const Eigen::Array3i last = (cell_of(place_m) + 1).min(size_ - 1);
    for (int x = first.x(); x <= last.x(); ++x) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int z = first.z(); z <= last.z(); ++z) {
          for (std::int32_t i = first_[index({x, y, z})]; i != kNone;
               i = next_[static_cast<std::size_t>(i)]) {
            const float distance2 =
                (places_m_[static_cast<std::size_t>(i)] - place_m).squaredNorm();
            if (distance2 < kSamePlace_m * kSamePlace_m &&
                is_it(static_cast<std::size_t>(i), distance2)) {
              return true;
            }
          }
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::int32_t kNone = -1;
  static constexpr float kMostCubes = 100;  ///< along the longest side

  Eigen::Array3i cell_of(const Eigen::Vector3f& place_m) const {
    return ((place_m - box_.min()).array() / side_m_).cast<int>();
  }
  std::size_t index(const Eigen::Array3i& cell) const {
    return static_cast<std::size_t>((cell.x() * size_.y() + cell.y()) * size_.z() + cell.z());
  }

  Eigen::AlignedBox3f box_;
  float side_m_ = kSamePlace_m;
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::int32_t> first_, next_;
  std::vector<Eigen::Vector3f> places_m_;
};

/// How near two poses may be, of barycentres and turns.
struct Nearness {
  float distance_m;  ///< below kSamePlace_m
  float angle_rad;
};

/// Of poses that are nearly the same the best, and of each place only the best few.
void keep_distinct(const PoseVerifier& verifier, Poses& poses, int per_place_n,
                   const Nearness& same) {
  sort_best_first(poses);
  const float same_trace = 1 + 2 * std::cos(same.angle_rad);
  std::vector<Eigen::Vector3f> barycentres_m;
  barycentres_m.reserve(poses.size());
  for (const PoseHypothesis& pose : poses) barycentres_m.push_back(verifier.barycentre_m(pose));
  Places places(barycentres_m);
  std::size_t kept_n = 0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const PoseHypothesis& pose = poses[p];
    int near_n = 0;
    const auto leaves_no_room = [&](std::size_t i, float distance2) {
      return ++near_n >= per_place_n ||
             (poses[i].part == pose.part && distance2 < same.distance_m * same.distance_m &&
              poses[i].R.cwiseProduct(pose.R).sum() > same_trace);
    };
    if (places.any_near(barycentres_m[p], leaves_no_room)) continue;
    places.add(barycentres_m[p]);
    poses[kept_n++] = poses[p];
  }
  poses.resize(kept_n);
}

/// A few steps of ICP, the first ones from farther away.
void place_coarsely(const PoseVerifier& verifier, const RegistrationParameters& parameters,
                    PoseHypothesis& pose) {
  for (int k = 0; k < kCoarseIcpSteps; ++k) {
    const bool early = k < kCoarseIcpSteps / 2;
    verifier.icp_step(pose, PoseVerifier::kCoarsePoints,
                      early ? kCoarseIcpTolerance_m : parameters.coarse_tolerance_m);
  }
  verifier.score(pose, PoseVerifier::kCoarsePoints, parameters.inlier_tolerance_m);
}

}  // namespace

HypothesesFound find_hypotheses(const DepthGrid& grid, const PoseVerifier& verifier,
                                std::span<const parts::Part* const> parts,
                                const RegistrationParameters& parameters, const IsLate& is_late) {
  Deadline deadline(is_late);
  const std::vector<Seed> seeds = choose_seeds(grid, parameters.seed_spacing_m);
  // Each seed and part has its own slots, so the threads' order does not show in the answer.
  const auto most = static_cast<std::size_t>(parameters.hypotheses_per_seed_n);
  Poses slots(seeds.size() * parts.size() * most);
  std::vector<Proposed> proposed(seeds.size() * parts.size());
  tbb::enumerable_thread_specific<WorkingMemory> memory;
  parallel_for(proposed.size(), [&](std::size_t i) {
    if (deadline.has_passed()) return;
    const std::size_t part = i % parts.size();
    proposed[i] = propose(grid, verifier, seeds[i / parts.size()], *parts[part],
                          static_cast<std::uint32_t>(part), parameters, memory.local(),
                          std::span(slots).subspan(i * most, most));
  });
  HypothesesFound found;
  found.poses.reserve(slots.size());
  for (std::size_t i = 0; i < proposed.size(); ++i) {
    found.compared_n += proposed[i].compared_n;
    const auto first = slots.begin() + static_cast<std::ptrdiff_t>(i * most);
    found.poses.insert(found.poses.end(), first,
                       first + static_cast<std::ptrdiff_t>(proposed[i].poses_n));
  }
  keep_distinct(verifier, found.poses, parameters.coarse_per_place_n, {0.006F, 0.25F});
  parallel_for(found.poses.size(), [&](std::size_t i) {
    if (!deadline.has_passed()) place_coarsely(verifier, parameters, found.poses[i]);
  });
  std::erase_if(found.poses, [&](const PoseHypothesis& pose) {
    return pose.fit < static_cast<float>(parameters.min_coarse_score);
  });
  keep_distinct(verifier, found.poses, parameters.fine_per_place_n, {0.004F, 0.15F});
  return found;
}

}  // namespace graspd::perception
