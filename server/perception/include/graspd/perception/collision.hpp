#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graspd/perception/free_space.hpp"
#include "graspd/perception/gripper_model.hpp"
#include "graspd/perception/grs.hpp"
#include "graspd/perception/lifting.hpp"
#include "graspd/perception/parameters.hpp"
#include "graspd/perception/scene.hpp"
#include "graspd/types/answer.hpp"
#include "graspd/types/request.hpp"

namespace graspd::perception {

/// What one check says of one grasp. Without memory of its own: sentences are made of those that
/// are answered, by `CollisionScene::reason`.
struct Verdict {
  CheckState state = CheckState::kNotRun;
  std::string_view culprit;            ///< of the gripper, where it failed: "palm", "jaw" or "cup"
  bool depends_on_opening = false;     ///< where it failed: another opening may pass
  std::optional<std::uint32_t> other;  ///< index of the part that is in the way

  bool failed() const { return state == CheckState::kFailed; }
};

/// In the order of Check.
using Verdicts = std::array<Verdict, std::size(EnumNames<Check>::values)>;

/// The verdict of one check.
inline Verdict& of(Verdicts& verdicts, Check check) {
  return verdicts[static_cast<std::size_t>(check)];
}
inline const Verdict& of(const Verdicts& verdicts, Check check) {
  return verdicts[static_cast<std::size_t>(check)];
}
/// The first check that failed.
std::optional<Check> first_failed(const Verdicts& verdicts);

/// Everything that a gripper or the part it holds may run into in one plan: what the camera has
/// seen or could not see, the registered parts, the bin. Grasps are poses in the floor's frame.
///
/// Each check has its switch in CollisionParameters. One that is off, or lacks what it needs, is
/// kNotRun and never passes silently. Not for several threads at once.
class CollisionScene {
 public:
  /// \param parts must outlive this. \param bin in the floor's frame, whatever its pose says.
  CollisionScene(const Scene& scene, std::span<const PlacedPart> parts,
                 const std::optional<Bin>& bin, const Gripper& gripper,
                 const CollisionParameters& parameters);

  /// The part that grasps are checked for from now on.
  void set_target(std::size_t target);

  /// The checks of the gripper at one opening, cheapest first, up to the first that fails; those
  /// after it are kNotRun. `held_part` is the same for every grasp of the target. `opening` is left
  /// alone: it is the grasp planner's.
  void check(const Eigen::Isometry3d& T_floor_grasp, double opening_m, Verdicts& verdicts) const;
  /// All checks, for an answer that says everything.
  void check_all(const Eigen::Isometry3d& T_floor_grasp, double opening_m,
                 Verdicts& verdicts) const;

  static constexpr double kAllRoom_m = 0.006;
  /// By how much wider, and longer where the floor is not nearer, the gripper could be and still
  /// pass, in steps of 2 mm up to kAllRoom_m. The target, which the clearance is for, does not
  /// count. \param opening_m at which the checks pass.
  double room_m(const Eigen::Isometry3d& T_floor_grasp, double opening_m) const;

  /// One check alone: the gripper against what the camera has seen, or has not.
  Verdict gripper_cloud(const Eigen::Isometry3d& T_floor_grasp, const SweptGripper& swept) const;
  /// Against the registered parts' meshes: `margin_m` from the others, touching from the target.
  Verdict gripper_parts(const Eigen::Isometry3d& T_floor_grasp, const SweptGripper& swept) const;
  /// Against walls and floor; a wall between the open jaws counts too.
  Verdict gripper_bin(const Eigen::Isometry3d& T_floor_grasp, const SweptGripper& swept) const;
  /// Of the target, lifted straight up: the same for each of its grasps.
  const Verdict& held_part() const { return held_part_; }

  /// Why a check failed or did not run; empty where it passed.
  /// \param ids of the parts, as the answer calls them.
  std::string reason(Check check, const Verdict& verdict, std::span<const std::uint32_t> ids) const;

 private:
  bool is_on(Check check) const;
  Verdict part_in_the_way(const Eigen::Isometry3d& T_floor_grasp, const SweptGripper& swept,
                          bool but_target) const;
  Verdict lift() const;

  CollisionParameters parameters_;
  Gripper gripper_;
  std::span<const PlacedPart> parts_;
  /// The target is taken out of it when the first grasp asks: of many parts none does.
  mutable std::optional<FreeSpace> free_space_;
  mutable bool is_target_out_ = false;
  std::optional<Bin> bin_;
  std::vector<OrientedBox> walls_;
  std::optional<Lifting> lifting_;
  std::vector<Eigen::Isometry3d> T_part_floor_;
  std::vector<Eigen::Vector3d> barycentres_m_;
  std::size_t target_ = 0;
  Verdict held_part_;
};

}  // namespace graspd::perception
