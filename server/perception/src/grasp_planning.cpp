#include "graspd/perception/grasp_planning.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace graspd::perception {
namespace {

constexpr int kOpenings = 3;

/// The openings that a grasp is tried with: the wanted clearance, and less of it for where
/// something leaves no room.
class Openings {
 public:
  Openings(double width_m, const Gripper& gripper, const GraspParameters& parameters)
      : width_m_(width_m), gripper_(gripper) {
    const double least_m = std::min(parameters.min_clearance_m, gripper.clearance_m);
    least_m_ = width_m + 2 * least_m;
    widest_m_ = std::min(width_m + 2 * gripper.clearance_m, gripper.max_opening_m);
  }

  /// Whether the part fits between the open jaws, and is held by the closed ones.
  bool fit() const { return least_m_ <= gripper_.max_opening_m && width_m_ >= closed_m(); }
  /// The k-th opening, the widest first.
  double operator[](int k) const {
    const double share = static_cast<double>(k) / (kOpenings - 1);
    const double opening_m = widest_m_ + share * (least_m_ - widest_m_);
    return std::clamp(opening_m, gripper_.min_opening_m, gripper_.max_opening_m);
  }
  std::string misfit() const {
    if (width_m_ < closed_m()) {
      return fmt::format("the part is {:.1f} mm wide here, the gripper closes to {:.1f} mm",
                         width_m_ * 1e3, closed_m() * 1e3);
    }
    return fmt::format(
        "the part is {:.1f} mm wide here and needs {:.1f} mm, the gripper opens {:.1f} mm",
        width_m_ * 1e3, least_m_ * 1e3, gripper_.max_opening_m * 1e3);
  }

 private:
  double closed_m() const { return gripper_.min_opening_m; }

  double width_m_, least_m_, widest_m_;
  const Gripper& gripper_;
};

/// A candidate on its way through the checks.
struct Trial {
  const GraspCandidate* candidate;
  double opening_m = 0;
  Verdicts verdicts;
};

Trial try_jaws(const GraspCandidate& candidate, const Gripper& gripper,
               const GraspParameters& parameters, const CollisionScene& scene) {
  const Openings openings(candidate.width_m, gripper, parameters);
  Trial trial{&candidate, openings[0], {}};
  if (!openings.fit()) {
    of(trial.verdicts, Check::kOpening).state = CheckState::kFailed;
    return trial;
  }
  for (int k = 0; k < kOpenings; ++k) {
    trial.opening_m = openings[k];
    scene.check(candidate.T_floor_grasp, trial.opening_m, trial.verdicts);
    const auto failure = first_failed(trial.verdicts);
    if (!failure || !of(trial.verdicts, *failure).depends_on_opening) break;
  }
  of(trial.verdicts, Check::kOpening).state = CheckState::kPassed;
  return trial;
}

Trial try_grasp(const GraspCandidate& candidate, const Gripper& gripper,
                const GraspParameters& parameters, const CollisionScene& scene) {
  if (gripper.kind == GripperKind::kParallelJaw) {
    return try_jaws(candidate, gripper, parameters, scene);
  }
  Trial trial{&candidate, 0, {}};
  scene.check(candidate.T_floor_grasp, 0, trial.verdicts);
  return trial;
}

std::string opening_reason(const Verdict& verdict, const GraspCandidate& candidate,
                           const Gripper& gripper, const GraspParameters& parameters) {
  if (verdict.state == CheckState::kNotRun) return "a suction cup has no opening";
  if (verdict.state == CheckState::kPassed) return {};
  return Openings(candidate.width_m, gripper, parameters).misfit();
}

PlannedGrasp explained(Trial trial, std::span<const std::uint32_t> ids, const Gripper& gripper,
                       const GraspParameters& parameters, const CollisionScene& scene) {
  const GraspCandidate& candidate = *trial.candidate;
  scene.check_all(candidate.T_floor_grasp, trial.opening_m, trial.verdicts);
  PlannedGrasp grasp{
      std::string(candidate.pick_point), candidate.T_floor_grasp, trial.opening_m, 0, {}};
  for (const auto& [check, name] : EnumNames<Check>::values) {
    const Verdict& verdict = of(trial.verdicts, check);
    grasp.checks.push_back({check, verdict.state,
                            check == Check::kOpening
                                ? opening_reason(verdict, candidate, gripper, parameters)
                                : scene.reason(check, verdict, ids)});
  }
  return grasp;
}

/// Where no candidate is at all: from above, so that the answer has something to say it of.
PlannedGrasp nowhere(const PlacedPart& part, const Gripper& gripper) {
  PlannedGrasp grasp;
  grasp.T_floor_grasp.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  grasp.T_floor_grasp.translation() = part.barycentre_m();
  for (const auto& [check, name] : EnumNames<Check>::values) {
    grasp.checks.push_back({check, CheckState::kNotRun, "there is no grasp to check"});
  }
  CheckReport& opening = grasp.checks[static_cast<std::size_t>(Check::kOpening)];
  opening.state = CheckState::kFailed;
  opening.reason =
      gripper.kind == GripperKind::kSuction
          ? fmt::format("no flat place of the part that faces up takes a cup of {:.1f} mm",
                        gripper.cup_diameter_m * 1e3)
          : "as the part lies, no approach from above has it between the jaws";
  return grasp;
}

/// What is said of a part that has no free grasp: what every check says of the preferred one.
PlannedGrasp explained_preferred(std::span<const GraspCandidate> candidates, const PlacedPart& part,
                                 std::span<const std::uint32_t> ids, const Gripper& gripper,
                                 const GraspParameters& parameters, const CollisionScene& scene) {
  if (candidates.empty()) return nowhere(part, gripper);
  return explained(try_grasp(candidates.front(), gripper, parameters, scene), ids, gripper,
                   parameters, scene);
}

/// Takes out the grasp with the least room, of several the least preferred, where a new one has
/// more. \returns whether it did.
bool make_way_for(double room_m, std::vector<PlannedGrasp>& free) {
  const auto least =
      std::ranges::min_element(free.rbegin(), free.rend(), {}, &PlannedGrasp::room_m);
  if (least->room_m >= room_m) return false;
  free.erase(std::next(least).base());
  return true;
}

bool has_all_room(const std::vector<PlannedGrasp>& free) {
  return std::ranges::any_of(
      free, [](const PlannedGrasp& grasp) { return grasp.room_m >= CollisionScene::kAllRoom_m; });
}

}  // namespace

PartGrasps plan_grasps_of(std::size_t target, std::span<const PlacedPart> parts,
                          std::span<const std::uint32_t> ids, const Gripper& gripper,
                          const GraspParameters& parameters, CollisionScene& scene,
                          bool explain_rejected) {
  PartGrasps grasps;
  const auto count_rejected = [&](Check check) {
    ++grasps.rejected_by_check_n[static_cast<std::size_t>(check)];
  };
  scene.set_target(target);
  // Whether the part can be lifted is the same for all its grasps, and known already.
  const bool can_be_lifted = !scene.held_part().failed();
  if (!can_be_lifted) {
    count_rejected(Check::kHeldPart);
    if (!explain_rejected) return grasps;
  }
  const std::vector<GraspCandidate> candidates =
      grasp_candidates(target, parts, gripper, parameters);
  if (can_be_lifted && candidates.empty()) count_rejected(Check::kOpening);
  const std::size_t tries_n =
      can_be_lifted ? static_cast<std::size_t>(parameters.tries_per_part_n) : 0;
  const auto most_n = static_cast<std::size_t>(parameters.grasps_per_part_n);
  for (std::size_t i = 0; i < std::min(tries_n, candidates.size()); ++i) {
    const Trial trial = try_grasp(candidates[i], gripper, parameters, scene);
    if (const auto failure = first_failed(trial.verdicts)) {
      count_rejected(*failure);
      continue;
    }
    const double room_m = scene.room_m(candidates[i].T_floor_grasp, trial.opening_m);
    if (grasps.free.size() == most_n && !make_way_for(room_m, grasps.free)) continue;
    grasps.free.push_back(explained(trial, ids, gripper, parameters, scene));
    grasps.free.back().room_m = room_m;
    // Beside a neighbour the preferred ones may have little room, and a later one all of it.
    if (grasps.free.size() == most_n && has_all_room(grasps.free)) break;
  }
  if (grasps.free.empty() && explain_rejected) {
    grasps.rejected =
        explained_preferred(candidates, parts[target], ids, gripper, parameters, scene);
  }
  return grasps;
}

}  // namespace graspd::perception
