#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

#include "graspd/parts/part.hpp"
#include "mesh_geometry.hpp"
#include "surface_match.hpp"
#include "symmetry_candidates.hpp"
#include "symmetry_group.hpp"

// A symmetry of a surface is a turn about its barycentre that lays it over itself. The inertia says
// about which axes that may be; each turn is then tried on the surface itself, and what holds is
// closed to a group, every element of which has been tried.

namespace graspd::parts {
namespace {

// Of the diameter: what a turn may move the surface off itself. A depth camera sees no less, and
// every cylinder of 16 sides or more is round to it.
constexpr double kTolerance = 0.01;
constexpr double kSameTurn_rad = 0.05;  // half of the least turn, 2π / 60
constexpr double kSameAxis = 1e-4;
constexpr int kMaxOrder = 60;
constexpr std::array kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59};
// A polygon of up to this many corners is not round, and worst off when turned by half a corner.
constexpr int kMaxCorners = 16;
// Axes that nearly hold are settled first. A part that is nearly round about many must not take
// long for that.
constexpr int kMaxTrials = 20;
using std::numbers::pi;

using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond turn_about(const Vector3d& axis, double angle_rad) {
  return Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

/// Of the mesh's file the axis that is most across.
Vector3d across(const Vector3d& axis) {
  Eigen::Index least = 0;
  axis.cwiseAbs().minCoeff(&least);
  const Vector3d unit = Vector3d::Unit(least);
  return (unit - unit.dot(axis) * axis).normalized();
}

class SymmetrySearch {
 public:
  explicit SymmetrySearch(const Mesh& mesh)
      : surface_(mesh),
        diameter_m_(diameter_m(mesh)),
        tolerance_m_(kTolerance * diameter_m_),
        candidates_(candidate_axes(surface_.triangles(), principal_axes(mesh), 2 * tolerance_m_)) {}

  Symmetries find() {
    if (const auto axis = find_continuous()) return symmetries_about(*axis);
    for (const CandidateAxis& candidate : candidates_.axes) examine(candidate, kPrimes.back());
    for (const CandidateAxis& candidate : candidates_.across) {
      if (is_known(turn_about(candidate.direction, pi)) || examine(candidate, 2)) break;
    }
    return {group_, {}};
  }

  const Vector3d& centre_m() const { return surface_.centre_m(); }

 private:
  /// As the axis is uncertain, so is where its turns take the surface.
  bool covers_roughly(const CandidateAxis& candidate, double angle_rad) {
    return surface_.covers_roughly(turn_about(candidate.direction, angle_rad),
                                   tolerance_m_ + candidate.uncertainty_rad * diameter_m_);
  }

  Vector3d settled_axis(const Vector3d& axis, double angle_rad) const {
    return surface_.settled(turn_about(axis, angle_rad)).vec().normalized();
  }

  // --- continuous axes ---

  bool turns_freely(const Vector3d& axis) {
    for (int corners_n = 2; corners_n <= kMaxCorners; ++corners_n) {
      // To either side in turn, so that ratchets show.
      const double angle_rad = (corners_n % 2 == 0 ? pi : -pi) / corners_n;
      if (!surface_.covers(turn_about(axis, angle_rad), tolerance_m_)) return false;
    }
    return true;
  }

  bool turns_freely_roughly(const CandidateAxis& candidate) {
    for (int corners_n = 2; corners_n <= kMaxCorners; ++corners_n) {
      if (!covers_roughly(candidate, pi / corners_n)) return false;
    }
    return true;
  }

  std::optional<Vector3d> find_continuous() {
    int trials_n = 0;
    for (const CandidateAxis& candidate : candidates_.axes) {
      if (turns_freely(candidate.direction)) return candidate.direction;
      if (trials_n == kMaxTrials || !turns_freely_roughly(candidate)) continue;
      ++trials_n;
      Vector3d axis = settled_axis(candidate.direction, pi);
      if (turns_freely(axis)) return axis;
    }
    return std::nullopt;
  }

  Symmetries symmetries_about(const Vector3d& axis) {
    Symmetries symmetries;
    const Vector3d b = across(axis);
    symmetries.continuous.push_back({axis, Vector3d::Zero()});
    if (turns_freely(b)) {
      symmetries.continuous.push_back({b, Vector3d::Zero()});  // a ball
    } else if (surface_.covers(turn_about(b, pi), tolerance_m_)) {
      symmetries.discrete.emplace_back(turn_about(b, pi));
    }
    return symmetries;
  }

  // --- discrete turns ---

  /// Whether turns by 2π / order do, those by 2π / (order / prime) being known to.
  bool has_order(const Vector3d& axis, int order, int prime) {
    for (int k = 1; k < order; ++k) {
      if (k % prime == 0) continue;
      if (!surface_.covers(turn_about(axis, 2 * pi * k / order), tolerance_m_)) return false;
    }
    return true;
  }

  int order_about(const Vector3d& axis, int max_prime) {
    int order = 1;
    for (const int prime : kPrimes) {
      if (prime > max_prime) break;
      while (order * prime <= kMaxOrder && has_order(axis, order * prime, prime)) order *= prime;
    }
    return order;
  }

  bool is_known(const Quaterniond& turn) const {
    return std::any_of(group_.begin(), group_.end(), [&](const Eigen::Isometry3d& known) {
      return Quaterniond(known.linear()).angularDistance(turn) < kSameTurn_rad;
    });
  }

  /// \returns whether the group has turns about the axis now.
  bool examine(const CandidateAxis& candidate, int max_prime) {
    if (trials_n_ > kMaxTrials) return false;
    if (add_turns_about(candidate.direction, max_prime)) return true;
    int trials_of_axis_n = 0;
    for (const int prime : kPrimes) {
      if (prime > max_prime || trials_of_axis_n == 2 || trials_n_ > kMaxTrials) break;
      const double angle_rad = 2 * pi / prime;
      if (is_known(turn_about(candidate.direction, angle_rad)) ||
          !covers_roughly(candidate, angle_rad)) {
        continue;
      }
      ++trials_of_axis_n;
      ++trials_n_;
      if (add_turns_about(settled_axis(candidate.direction, angle_rad), max_prime)) return true;
    }
    return false;
  }

  bool add_turns_about(const Vector3d& axis, int max_prime) {
    const int order = order_about(axis, max_prime);
    if (order == 1) return false;
    if (is_known(turn_about(axis, 2 * pi / order))) return true;
    const Vector3d settled = settled_axis(axis, 2 * pi / order);
    const bool is_same = settled.isApprox(axis, kSameAxis);
    const int settled_order = is_same ? order : order_about(settled, max_prime);
    const bool is_better = settled_order >= order;
    return add_generator(
        turn_about(is_better ? settled : axis, 2 * pi / (is_better ? settled_order : order)));
  }

  /// \returns whether all that the group becomes with it holds; else it stays as it was.
  bool add_generator(const Quaterniond& turn) {
    generators_.emplace_back(turn);
    auto group = close_group(generators_, kSameTurn_rad);
    if (group) make_exact(*group);
    const bool holds = group && std::all_of(group->begin(), group->end(), [this](const auto& T) {
                         const Quaterniond element(T.linear());
                         return is_known(element) || surface_.covers(element, tolerance_m_);
                       });
    if (holds) {
      group_ = std::move(*group);
    } else {
      generators_.pop_back();
      ++trials_n_;
    }
    return holds;
  }

  SurfaceMatch surface_;
  double diameter_m_, tolerance_m_;
  CandidateAxes candidates_;
  std::vector<Eigen::Isometry3d> generators_, group_;
  int trials_n_ = 0;
};

/// What was found about the barycentre, in the part frame.
void move_to(const Vector3d& centre_m, Symmetries& symmetries) {
  for (Eigen::Isometry3d& T : symmetries.discrete) {
    T.translation() = centre_m - T.linear() * centre_m;
  }
  for (ContinuousSymmetry& symmetry : symmetries.continuous) {
    symmetry.axis = with_fixed_sign(symmetry.axis);
    symmetry.point_m = centre_m - centre_m.dot(symmetry.axis) * symmetry.axis;
  }
}

}  // namespace

Symmetries find_symmetries(const Mesh& mesh) {
  if (!(surface_area_m2(mesh) > 0)) return {};
  SymmetrySearch search(mesh);
  Symmetries symmetries = search.find();
  move_to(search.centre_m(), symmetries);
  return symmetries;
}

}  // namespace graspd::parts
