#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "graspd/types/answer.hpp"
#include "graspd/types/result.hpp"

namespace graspd::agent {

/// What the arm and the gripper do in one pick, in this order, and what they do to stir the pile.
enum class Step {
  kOpen,
  kPreGrasp,
  kApproach,
  kClose,
  kLift,
  kCheck,  ///< whether the gripper holds something: after the lift, the transfer, the release, a
           ///< stir
  kTransfer,
  kPlace,
  kRelease,
  kRetreat,
  kOutOfView,
  kStirAbove,
  kStirDown,
  kStirAcross,
  kStirUp,
};

}  // namespace graspd::agent

template <>
struct graspd::EnumNames<graspd::agent::Step> {
  using Step = agent::Step;
  static constexpr std::string_view what = "step";
  static constexpr std::pair<Step, std::string_view> values[] = {{Step::kPreGrasp, "pre_grasp"},
                                                                 {Step::kOpen, "open"},
                                                                 {Step::kApproach, "approach"},
                                                                 {Step::kClose, "close"},
                                                                 {Step::kLift, "lift"},
                                                                 {Step::kCheck, "check"},
                                                                 {Step::kTransfer, "transfer"},
                                                                 {Step::kPlace, "place"},
                                                                 {Step::kRelease, "release"},
                                                                 {Step::kRetreat, "retreat"},
                                                                 {Step::kOutOfView, "out_of_view"},
                                                                 {Step::kStirAbove, "stir_above"},
                                                                 {Step::kStirDown, "stir_down"},
                                                                 {Step::kStirAcross, "stir_across"},
                                                                 {Step::kStirUp, "stir_up"}};
};

namespace graspd::agent {

/// How the arm gets to a pose.
enum class Path {
  kFree,      ///< any way that touches nothing
  kStraight,  ///< the grasp frame moves on a straight line
};

/// One order to the arm: bring the grasp frame (the middle between the finger tips) to this pose.
struct Motion {
  Step step = Step::kPreGrasp;
  Path path = Path::kFree;
  Eigen::Isometry3d T_base_grasp = Eigen::Isometry3d::Identity();
  double speed_share = 1;      ///< of the speed that the arm would take, in (0, 1]
  double opening_width_m = 0;  ///< how far the jaws may be apart meanwhile
};

/// What every arm refuses, whatever it could reach.
/// \returns INVALID_ARGUMENT with the step and what is wrong: a pose that is none, a share of speed
/// out of (0, 1], an opening below 0.
Result<void> validate(const Motion& motion);
/// The first one's.
Result<void> validate(std::span<const Motion> motions);

/// The six motions of one pick. Above the place the arm keeps the height it retreats by.
struct PickMotions {
  Motion pre_grasp;
  Motion approach;
  Motion lift;
  Motion transfer;
  Motion place;
  Motion retreat;

  std::array<Motion, 6> all() const {
    return {pre_grasp, approach, lift, transfer, place, retreat};
  }
};

/// Backs off from the grasp by its standoff along the approach, lifts by its retreat along base z.
/// \param T_base_place where the grasp frame is when the gripper lets go.
PickMotions pick_motions(const Grasp& grasp, const Eigen::Isometry3d& T_base_place);

}  // namespace graspd::agent

template <>
struct graspd::EnumNames<graspd::agent::Path> {
  using Path = agent::Path;
  static constexpr std::string_view what = "path";
  static constexpr std::pair<Path, std::string_view> values[] = {{Path::kFree, "free"},
                                                                 {Path::kStraight, "straight"}};
};
