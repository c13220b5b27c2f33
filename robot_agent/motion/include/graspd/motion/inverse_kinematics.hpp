#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "graspd/motion/arm_model.hpp"

namespace graspd::motion {

enum class IkKind {
  kAnno,  ///< closed form, for arms built like the PROBOT Anno
  kKdl,   ///< Orocos KDL's LMA, for any arm
};

/// From a pose of the flange to the joints. Belongs to one thread.
class InverseKinematics {
 public:
  virtual ~InverseKinematics() = default;

  /// All that was found within the joints' limits, nearest to `near_rad` first; "near" is by the
  /// joint that has furthest to turn.
  /// \returns INVALID_ARGUMENT with the reason where there is none.
  virtual Result<std::vector<agent::Joints>> solve(const Eigen::Isometry3d& T_base_flange,
                                                   const agent::Joints& near_rad) = 0;
  /// The next step of a path that `near_rad` is on: the solution nearest to it, whatever the
  /// limits.
  /// \returns INVALID_ARGUMENT with the reason where that one leaves the limits or there is none.
  virtual Result<agent::Joints> follow(const Eigen::Isometry3d& T_base_flange,
                                       const agent::Joints& near_rad) = 0;
};

/// \returns INVALID_ARGUMENT where the arm is not of that kind.
Result<std::unique_ptr<InverseKinematics>> make_inverse_kinematics(IkKind kind,
                                                                   const ArmModel& arm);

}  // namespace graspd::motion

template <>
struct graspd::EnumNames<graspd::motion::IkKind> {
  using Kind = motion::IkKind;
  static constexpr std::string_view what = "kind of inverse kinematics";
  static constexpr std::pair<Kind, std::string_view> values[] = {{Kind::kAnno, "anno"},
                                                                 {Kind::kKdl, "kdl"}};
};
