#include "graspd/perception/grasp_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace graspd::perception {
namespace {

using Eigen::Vector3d;
using parts::PickPoint;

constexpr int kAzimuths = 8;           // of the principal axis' tilts
constexpr double kFloorGap_m = 0.001;  // below finger tips that need not reach as deep
constexpr double kSameGrasp_m = 0.001;
constexpr double kSameCosine = 0.999;
constexpr double kRoundOff = 1e-9;

/// A pick point with the approach to it that is nearest to vertical, in the part's frame.
struct Reached {
  const PickPoint* point = nullptr;
  double preference = 0;
  Vector3d approach;
};

bool is_same(const GraspCandidate& a, const GraspCandidate& b) {
  const auto cosine = [&](int axis) {
    return a.T_floor_grasp.linear().col(axis).dot(b.T_floor_grasp.linear().col(axis));
  };
  return (a.T_floor_grasp.translation() - b.T_floor_grasp.translation()).squaredNorm() <
             kSameGrasp_m * kSameGrasp_m &&
         cosine(2) > kSameCosine && std::abs(cosine(0)) > kSameCosine;
}

Eigen::Isometry3d grasp_frame(const Vector3d& origin_m, const Vector3d& approach,
                              const Vector3d& closing) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << closing, approach.cross(closing), approach;
  T.translation() = origin_m;
  return T;
}

class CandidateSearch {
 public:
  CandidateSearch(const PlacedPart& part, const Gripper& gripper, const GraspParameters& parameters)
      : part_(part),
        gripper_(gripper),
        parameters_(parameters),
        down_part_(part.T_floor_part.linear().transpose() * -Vector3d::UnitZ()),
        kind_(name_of(gripper.kind)),
        most_n_(static_cast<std::size_t>(parameters.tries_per_part_n)),
        min_cosine_(std::cos(parameters.max_tilt_rad) - kRoundOff),
        min_taught_cosine_(std::min(min_cosine_, std::cos(parameters.max_taught_tilt_rad))) {
    candidates_.reserve(most_n_ + 1);
  }

  /// The approach nearest to vertical at each pick point; one place is left for the principal axis.
  void add_pick_points() {
    for (const PickPoint& point : part_.part->pick_points) {
      if (auto reached = reach(point)) reached_.push_back(*reached);
    }
    std::sort(reached_.begin(), reached_.end(), [](const Reached& a, const Reached& b) {
      return a.preference != b.preference ? a.preference > b.preference : a.point < b.point;
    });
    std::size_t used_n = 0;
    for (; used_n < reached_.size() && candidates_.size() + 1 < most_n_; ++used_n) {
      add(candidate_at(*reached_[used_n].point, reached_[used_n].approach));
    }
    reached_.resize(used_n);
  }

  /// Straight down, or tilted in all directions.
  void add_principal_axis(const Vector3d& origin_m, const Vector3d& closing, double tilt_rad) {
    for (int k = 0; k < (tilt_rad > 0 ? kAzimuths : 1); ++k) {
      if (candidates_.size() >= most_n_) return;
      const double azimuth = 2 * std::numbers::pi * k / kAzimuths;
      const Vector3d approach(std::sin(tilt_rad) * std::cos(azimuth),
                              std::sin(tilt_rad) * std::sin(azimuth), -std::cos(tilt_rad));
      const Vector3d across = (closing - approach * approach.dot(closing)).normalized();
      GraspCandidate candidate{kPrincipalAxis, grasp_frame(origin_m, approach, across), 0,
                               parameters_.principal_axis_priority - approach.z()};
      const auto width_m = width_between_jaws_m(part_, candidate.T_floor_grasp, gripper_);
      if (!width_m) continue;
      candidate.width_m = *width_m;
      add(candidate);
    }
  }

  /// The pick points' approaches turned about the closing direction, either way.
  void add_turned(double tilt_rad) {
    for (const Reached& reached : reached_) {
      for (const double turn_rad : {tilt_rad, -tilt_rad}) {
        if (candidates_.size() >= most_n_) return;
        const PickPoint& point = *reached.point;
        const Vector3d approach = std::cos(turn_rad) * reached.approach +
                                  std::sin(turn_rad) * point.closing.cross(reached.approach);
        const bool within_cone =
            approach.dot(point.approach) >= std::cos(point.approach_cone_rad) - kRoundOff;
        if (within_cone && down_part_.dot(approach) >= least_cosine(point)) {
          add(candidate_at(point, approach));
        }
      }
    }
  }

  std::vector<GraspCandidate> take() {
    if (candidates_.empty() && nearest_miss_) return {*nearest_miss_};
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const auto& a, const auto& b) { return a.preference > b.preference; });
    return std::move(candidates_);
  }

 private:
  double least_cosine(const PickPoint& point) const {
    return point.is_proposed ? min_cosine_ : min_taught_cosine_;
  }

  std::optional<Reached> reach(const PickPoint& point) const {
    if (!point.gripper.empty() && point.gripper != kind_) return std::nullopt;
    const double along = point.approach.dot(down_part_);
    if (gripper_.kind == GripperKind::kSuction) {  // a cup comes along the normal
      if (along < least_cosine(point)) return std::nullopt;
      return Reached{&point, point.priority + along, point.approach};
    }
    // Turned freely about the closing direction, the approach gets as near to vertical as this.
    const double across = point.closing.dot(down_part_);
    const double best_cosine = std::sqrt(std::max(0.0, 1 - across * across));
    if (best_cosine < std::max(kRoundOff, least_cosine(point))) return std::nullopt;
    const double cone_cosine = std::cos(point.approach_cone_rad);
    if (along >= best_cosine * cone_cosine) {
      return Reached{&point, point.priority + best_cosine,
                     (down_part_ - across * point.closing) / best_cosine};
    }
    // As far as the cone goes.
    const Vector3d aside = point.closing.cross(point.approach);
    const double sine = std::copysign(std::sin(point.approach_cone_rad), aside.dot(down_part_));
    const Vector3d approach = cone_cosine * point.approach + sine * aside;
    const double cosine = approach.dot(down_part_);
    if (cosine < least_cosine(point)) return std::nullopt;
    return Reached{&point, point.priority + cosine, approach};
  }

  GraspCandidate candidate_at(const PickPoint& point, const Vector3d& approach_part) const {
    const Eigen::Matrix3d R = part_.T_floor_part.linear();
    const Vector3d approach = R * approach_part;
    const Eigen::Isometry3d T_at_point =
        grasp_frame(part_.T_floor_part * point.position_m, approach, R * point.closing);
    GraspCandidate candidate{point.name, T_at_point, point.width_m, point.priority - approach.z()};
    candidate.T_floor_grasp.translation() += tip_reach_m(point, T_at_point) * approach;
    return candidate;
  }

  /// Of flat parts, finger tips need not reach so deep as to touch the floor.
  double tip_reach_m(const PickPoint& point, const Eigen::Isometry3d& T_at_point) const {
    if (!(point.tip_reach_m > 0)) return 0;
    const Eigen::Matrix3d R = T_at_point.linear();
    const double half_width_m = point.width_m / 2 + gripper_.clearance_m + gripper_.jaw_size_m.x();
    const double lowest_m = T_at_point.translation().z() - std::abs(R(2, 0)) * half_width_m -
                            std::abs(R(2, 1)) * gripper_.jaw_size_m.y() / 2;
    return std::clamp((lowest_m - kFloorGap_m) / -R(2, 2), 0.0, point.tip_reach_m);
  }

  /// By how much the gripper can't take it; at most 0 where it can.
  double miss_m(const GraspCandidate& candidate) const {
    if (gripper_.kind == GripperKind::kParallelJaw) {
      return std::max(candidate.width_m - gripper_.max_opening_m,
                      gripper_.min_opening_m - candidate.width_m);
    }
    return gripper_.cup_diameter_m - candidate.width_m;
  }

  void add(const GraspCandidate& candidate) {
    const double missed_m = miss_m(candidate);
    if (missed_m > 0) {
      if (gripper_.kind == GripperKind::kParallelJaw && missed_m < least_miss_m_) {
        least_miss_m_ = missed_m;
        nearest_miss_ = candidate;
      }
      return;
    }
    const bool is_known = std::any_of(candidates_.begin(), candidates_.end(),
                                      [&](const auto& known) { return is_same(known, candidate); });
    if (!is_known) candidates_.push_back(candidate);
  }

  const PlacedPart& part_;
  const Gripper& gripper_;
  const GraspParameters& parameters_;
  Vector3d down_part_;
  std::string_view kind_;
  std::size_t most_n_;
  double min_cosine_, min_taught_cosine_;
  std::vector<Reached> reached_;
  std::vector<GraspCandidate> candidates_;
  std::optional<GraspCandidate> nearest_miss_;
  double least_miss_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<GraspCandidate> grasp_candidates(std::size_t target, std::span<const PlacedPart> parts,
                                             const Gripper& gripper,
                                             const GraspParameters& parameters) {
  const PlacedPart& part = parts[target];
  CandidateSearch search(part, gripper, parameters);
  search.add_pick_points();
  if (gripper.kind == GripperKind::kSuction) return search.take();

  const Vector3d origin_m = grasp_point(target, parts, parameters);
  const Vector3d closing = closing_direction(part);
  search.add_principal_axis(origin_m, closing, 0);
  const auto tilts_n =
      static_cast<int>(parameters.max_tilt_rad / parameters.tilt_step_rad + kRoundOff);
  for (int k = 1; k <= tilts_n; ++k) search.add_turned(k * parameters.tilt_step_rad);
  for (int k = 1; k <= tilts_n; ++k) {
    search.add_principal_axis(origin_m, closing, k * parameters.tilt_step_rad);
  }
  return search.take();
}

}  // namespace graspd::perception
