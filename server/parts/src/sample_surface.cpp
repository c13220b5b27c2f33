#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "graspd/parts/mesh.hpp"
#include "visit_surface.hpp"

// Poisson-disk sampling by dart throwing: of many more candidates than are wanted, each is kept
// unless a kept one is too near.

namespace graspd::parts {
namespace {

// Kept points lie 0.8 spacings apart or more; thrown to exhaustion, that makes about one point per
// spacing², and no spot of the surface is farther than a spacing from a point.
constexpr double kMinDistanceShare = 0.8;
constexpr double kCandidatesPerPoint = 32;
// The two sides of a thin sheet face apart: they are sampled each for itself.
constexpr float kSameSideCosine = -0.5F;

/// Points kept so far, in cells as wide as the distance they must keep.
class KeptPoints {
 public:
  explicit KeptPoints(double min_distance_m)
      : cell_m_(min_distance_m),
        min_squared_m2_(static_cast<float>(min_distance_m * min_distance_m)) {}

  void add_unless_too_near(const SurfacePoint& candidate) {
    const Eigen::Array3i cell =
        (candidate.position_m.cast<double>().array() / cell_m_).floor().cast<int>();
    // The own cell first: it holds the neighbour most often.
    static constexpr std::array<int, 3> kSteps{0, -1, 1};
    for (const int dx : kSteps) {
      for (const int dy : kSteps) {
        for (const int dz : kSteps) {
          const auto found = cells_.find(key(cell + Eigen::Array3i(dx, dy, dz)));
          if (found != cells_.end() && is_too_near(found->second, candidate)) return;
        }
      }
    }
    cells_[key(cell)].push_back(points_.size());
    points_.push_back(candidate);
  }

  std::vector<SurfacePoint> take() { return std::move(points_); }

 private:
  static std::uint64_t key(const Eigen::Array3i& cell) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      key = key << 21U | (static_cast<std::uint64_t>(cell[axis]) & 0x1FFFFFU);
    }
    return key;
  }

  bool is_too_near(const std::vector<std::size_t>& indices, const SurfacePoint& candidate) const {
    return std::any_of(indices.begin(), indices.end(), [&](std::size_t i) {
      return (points_[i].position_m - candidate.position_m).squaredNorm() < min_squared_m2_ &&
             points_[i].normal.dot(candidate.normal) > kSameSideCosine;
    });
  }

  double cell_m_;
  float min_squared_m2_;
  std::vector<SurfacePoint> points_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

}  // namespace

std::vector<SurfacePoint> sample_surface(const Mesh& mesh, double spacing_m) {
  if (!(spacing_m > 0)) throw std::invalid_argument("sample_surface: the spacing must be above 0");
  const double candidates_per_m2 = kCandidatesPerPoint / (spacing_m * spacing_m);
  KeptPoints kept(kMinDistanceShare * spacing_m);
  visit_surface(mesh, candidates_per_m2,
                [&kept](const SurfacePoint& candidate) { kept.add_unless_too_near(candidate); });
  return kept.take();
}

}  // namespace graspd::parts
