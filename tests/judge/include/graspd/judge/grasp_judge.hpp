#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "graspd/parts/part.hpp"
#include "graspd/types/request.hpp"

/// Whether a grasp would have worked, from the true poses and the meshes alone. Nothing here knows
/// how grasps are planned. All in the bin's frame: z up, origin in the middle of its floor.
namespace graspd::judge {

/// Where a part truly lies.
struct TruePart {
  const parts::Part* part = nullptr;
  Eigen::Isometry3d T_bin_part = Eigen::Isometry3d::Identity();
};

/// A box open at the top.
struct TrueBin {
  Eigen::Vector3d inner_size_m = Eigen::Vector3d::Zero();
  double wall_m = 0;
};

/// What a gripper would do.
struct TrueGrasp {
  Eigen::Isometry3d T_bin_grasp = Eigen::Isometry3d::Identity();
  double opening_width_m = 0;
  double standoff_m = 0;
};

/// What is wrong with a grasp. Collisions come before what the jaws hold.
enum class Finding {
  kGood,           ///< free of collision, and holds one part in force closure
  kCollisionPart,  ///< of jaws or palm, at the grasp or on the way from pre-grasp to it
  kCollisionWall,
  kCollisionFloor,
  kNothingBetween,  ///< the jaws close on nothing
  kTwoParts,        ///< they hold more than one
  kNoForceClosure,  ///< the part slips away
};

struct Judgement {
  Finding finding = Finding::kGood;
  std::optional<std::size_t> part;  ///< that is held, or in the way
};

/// A pile whose true poses are known, and a gripper.
class GraspJudge {
 public:
  /// Parallel jaws. \param friction coefficient between jaws and parts.
  GraspJudge(std::vector<TruePart> parts, const TrueBin& bin, const Gripper& gripper,
             double friction = 0.4);
  GraspJudge(GraspJudge&&) noexcept;
  GraspJudge& operator=(GraspJudge&&) noexcept;
  ~GraspJudge();

  const std::vector<TruePart>& parts() const;
  const Gripper& gripper() const;

  Judgement judge(const TrueGrasp& grasp) const;

  /// Whether the part goes straight up without pushing another: nothing lies on it or holds it.
  bool lifts_free(std::size_t part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspd::judge

template <>
struct graspd::EnumNames<graspd::judge::Finding> {
  static constexpr std::string_view what = "finding";
  static constexpr std::pair<judge::Finding, std::string_view> values[] = {
      {judge::Finding::kGood, "good"},
      {judge::Finding::kCollisionPart, "collision_part"},
      {judge::Finding::kCollisionWall, "collision_wall"},
      {judge::Finding::kCollisionFloor, "collision_floor"},
      {judge::Finding::kNothingBetween, "nothing_between"},
      {judge::Finding::kTwoParts, "two_parts"},
      {judge::Finding::kNoForceClosure, "no_force_closure"}};
};
