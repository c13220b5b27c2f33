#include "graspd/judge/grasp_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace graspd::judge {
namespace {

using std::chrono::steady_clock;

/// Between the antipodal pair and the tips.
constexpr std::array kDepths_m{0.004, 0.010, 0.018, 0.030};
/// On each side of the part.
constexpr std::array kClearances_m{0.005, 0.002, 0.001};
/// Of normals at the two ends of a pair: wider than any friction cone of interest, the judge
/// decides.
constexpr double kLeastCosine = 0.9;
constexpr double kSteepest_rad = 1.3;  ///< of the approach from the vertical

/// Two places of a part's surface that face away from each other, in the part's frame.
struct AntipodalPair {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d closing;
  double width_m;
};

/// Where the line p + t d, t > 0, leaves the solid. (Möller and Trumbore)
std::vector<double> exits_m(const parts::Mesh& mesh, const Eigen::Vector3d& p_m,
                            const Eigen::Vector3d& d) {
  constexpr double kBeyondStart_m = 1e-4;
  std::vector<double> exits;
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
      return mesh.vertices_m[static_cast<std::size_t>(triangle[i])].cast<double>();
    };
    const Eigen::Vector3d edge_1 = corner(1) - corner(0);
    const Eigen::Vector3d edge_2 = corner(2) - corner(0);
    const Eigen::Vector3d normal = edge_1.cross(edge_2);
    const double facing = normal.dot(d);
    if (facing < kLeastCosine * normal.norm()) continue;  // enters, or leaves too slantwise
    const Eigen::Vector3d q = (p_m - corner(0)).cross(d);
    const double u = -q.dot(edge_2) / facing;
    const double v = q.dot(edge_1) / facing;
    if (u < 0 || v < 0 || u + v > 1) continue;
    const double t_m = normal.dot(corner(0) - p_m) / facing;
    if (t_m > kBeyondStart_m) exits.push_back(t_m);
  }
  return exits;
}

std::vector<AntipodalPair> antipodal_pairs(const parts::Mesh& mesh, double spacing_m,
                                           double max_width_m) {
  std::vector<AntipodalPair> pairs;
  for (const parts::SurfacePoint& point : parts::sample_surface(mesh, spacing_m)) {
    const Eigen::Vector3d p_m = point.position_m.cast<double>();
    const Eigen::Vector3d inwards = -point.normal.cast<double>();
    for (const double width_m : exits_m(mesh, p_m, inwards)) {
      if (width_m <= max_width_m) {
        pairs.push_back({p_m + inwards * width_m / 2, inwards, width_m});
      }
    }
  }
  return pairs;
}

/// Approaches across the closing direction, the steepest first.
std::vector<Eigen::Vector3d> approaches_across(const Eigen::Vector3d& closing, int count) {
  const Eigen::Vector3d first = closing.unitOrthogonal();
  std::vector<Eigen::Vector3d> approaches;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d approach = Eigen::AngleAxisd(2 * M_PI * i / count, closing) * first;
    if (-approach.z() >= std::cos(kSteepest_rad)) approaches.push_back(approach);
  }
  std::ranges::sort(approaches, {}, [](const Eigen::Vector3d& a) { return a.z(); });
  return approaches;
}

std::vector<std::size_t> highest_first(const std::vector<TruePart>& parts) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, std::greater(), [&](std::size_t i) {
    return (parts[i].T_bin_part * parts[i].part->barycentre_m).z();
  });
  return order;
}

/// The first good grasp at one pair.
std::optional<TrueGrasp> try_pair(const GraspJudge& judge, const AntipodalPair& pair,
                                  const Eigen::Isometry3d& T_bin_part,
                                  const SearchOptions& options) {
  const Eigen::Vector3d closing = T_bin_part.linear() * pair.closing;
  const Eigen::Vector3d centre_m = T_bin_part * pair.centre_m;
  for (const Eigen::Vector3d& approach : approaches_across(closing, options.approaches_n)) {
    TrueGrasp grasp;
    grasp.standoff_m = options.standoff_m;
    grasp.T_bin_grasp.linear() << closing, approach.cross(closing), approach;
    for (const double depth_m : kDepths_m) {
      grasp.T_bin_grasp.translation() = centre_m + depth_m * approach;
      if (grasp.T_bin_grasp.translation().z() < 0) continue;
      for (const double clearance_m : kClearances_m) {
        grasp.opening_width_m = pair.width_m + 2 * clearance_m;
        if (grasp.opening_width_m > judge.gripper().max_opening_m) continue;
        if (judge.judge(grasp).finding == Finding::kGood) return grasp;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

SearchResult find_good_grasp(const GraspJudge& judge, const SearchOptions& options) {
  const auto start = steady_clock::now();
  const double max_width_m = judge.gripper().max_opening_m - 2 * kClearances_m.back();
  std::map<const parts::Part*, std::vector<AntipodalPair>> pairs;
  for (const TruePart& part : judge.parts()) {
    if (!pairs.contains(part.part)) {
      pairs[part.part] = antipodal_pairs(part.part->mesh, options.spacing_m, max_width_m);
    }
  }
  for (const std::size_t i : highest_first(judge.parts())) {
    for (const AntipodalPair& pair : pairs[judge.parts()[i].part]) {
      if (steady_clock::now() - start > options.give_up_after) return {std::nullopt, false};
      if (auto grasp = try_pair(judge, pair, judge.parts()[i].T_bin_part, options)) {
        return {grasp, true};
      }
    }
  }
  return {std::nullopt, true};
}

}  // namespace graspd::judge
