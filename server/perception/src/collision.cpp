#include "graspd/perception/collision.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kernel_pose.hpp"

namespace graspd::perception {
namespace {

/// Of a suction cup: its lip gives way, so that it may be a little in the part that it sits on.
constexpr double kLip_m = 0.003;
/// What `CollisionScene::room_m` tries. Poses that are right are off by 1 to 2.5 mm in the median,
/// by part.
constexpr double kRooms_m[] = {CollisionScene::kAllRoom_m, 0.004, 0.002};

std::vector<OrientedBox> walls_of(const Bin& bin) {
  const Eigen::Vector3d& inner_m = bin.inner_size_m;
  const double wall_m = bin.wall_thickness_m;
  std::vector<OrientedBox> walls;
  for (const int axis : {0, 1}) {
    Eigen::Vector3d half_m = inner_m / 2;
    half_m[1 - axis] += wall_m;  // the corners
    half_m[axis] = wall_m / 2;
    for (const int side : {-1, 1}) {
      OrientedBox& wall = walls.emplace_back();
      wall.half_m = half_m;
      wall.centre_m = Eigen::Vector3d(0, 0, inner_m.z() / 2);
      wall.centre_m[axis] = side * (inner_m[axis] + wall_m) / 2;
    }
  }
  return walls;
}

double lowest_m(const OrientedBox& box) {
  return box.centre_m.z() - box.axes.row(2).cwiseAbs().dot(box.half_m);
}

/// Whether a ball reaches into a box about its own origin.
bool reaches(const Eigen::Vector3d& centre_m, double radius_m, const Eigen::Vector3d& half_m) {
  return (centre_m.cwiseAbs() - half_m).cwiseMax(0).squaredNorm() <= radius_m * radius_m;
}

TriangleSpan span_of(const parts::TriangleGroups& groups) {
  return {groups.corners_m.data(), groups.x_m.data(),      groups.y_m.data(),
          groups.z_m.data(),       groups.radius_m.data(), groups.size()};
}

Verdict passed() { return {CheckState::kPassed, {}, false, std::nullopt}; }

Verdict failed(const GripperBox& box, std::optional<std::uint32_t> other = std::nullopt) {
  return {CheckState::kFailed, box.name, box.moves_with_opening, other};
}

}  // namespace

std::optional<Check> first_failed(const Verdicts& verdicts) {
  for (const auto& [check, name] : EnumNames<Check>::values) {
    if (of(verdicts, check).failed()) return check;
  }
  return std::nullopt;
}

CollisionScene::CollisionScene(const Scene& scene, std::span<const PlacedPart> parts,
                               const std::optional<Bin>& bin, const Gripper& gripper,
                               const CollisionParameters& parameters)
    : parameters_(parameters), gripper_(gripper), parts_(parts), bin_(bin) {
  if (scene.seen && is_on(Check::kGripperCloud)) free_space_.emplace(scene, parts, bin, parameters);
  if (bin) walls_ = walls_of(*bin);
  if (is_on(Check::kHeldPart)) lifting_.emplace(parts, parameters);
  for (const PlacedPart& part : parts) {
    T_part_floor_.push_back(part.T_floor_part.inverse());
    barycentres_m_.push_back(part.barycentre_m());
  }
}

bool CollisionScene::is_on(Check check) const {
  switch (check) {
    case Check::kGripperCloud:
      return parameters_.gripper_cloud;
    case Check::kGripperParts:
      return parameters_.gripper_parts;
    case Check::kGripperBin:
      return parameters_.gripper_bin;
    case Check::kHeldPart:
      return parameters_.held_part;
    case Check::kOpening:
      break;
  }
  return true;
}

void CollisionScene::set_target(std::size_t target) {
  target_ = target;
  is_target_out_ = false;
  held_part_ = lift();
}

void CollisionScene::check(const Eigen::Isometry3d& T_floor_grasp, double opening_m,
                           Verdicts& verdicts) const {
  for (const Check later : {Check::kGripperCloud, Check::kGripperParts, Check::kGripperBin}) {
    of(verdicts, later) = {};
  }
  of(verdicts, Check::kHeldPart) = held_part_;
  const SweptGripper swept(gripper_, opening_m);
  of(verdicts, Check::kGripperBin) = gripper_bin(T_floor_grasp, swept);
  if (of(verdicts, Check::kGripperBin).failed()) return;
  of(verdicts, Check::kGripperParts) = gripper_parts(T_floor_grasp, swept);
  if (of(verdicts, Check::kGripperParts).failed()) return;
  of(verdicts, Check::kGripperCloud) = gripper_cloud(T_floor_grasp, swept);
}

void CollisionScene::check_all(const Eigen::Isometry3d& T_floor_grasp, double opening_m,
                               Verdicts& verdicts) const {
  const SweptGripper swept(gripper_, opening_m);
  of(verdicts, Check::kGripperBin) = gripper_bin(T_floor_grasp, swept);
  of(verdicts, Check::kGripperParts) = gripper_parts(T_floor_grasp, swept);
  of(verdicts, Check::kGripperCloud) = gripper_cloud(T_floor_grasp, swept);
  of(verdicts, Check::kHeldPart) = held_part_;
}

double CollisionScene::room_m(const Eigen::Isometry3d& T_floor_grasp, double opening_m) const {
  // The floor is where it is said to be.
  double above_floor_m = kRooms_m[0];
  const SweptGripper asked(gripper_, opening_m);  // lives as long as the loop over its boxes
  for (const GripperBox& box : asked.boxes()) {
    above_floor_m = std::min(above_floor_m, lowest_m(OrientedBox(T_floor_grasp, box.box_m)));
  }
  for (const double room_m : kRooms_m) {
    const double deeper_m = std::clamp(above_floor_m, 0.0, room_m);
    const SweptGripper wider(gripper_, opening_m, room_m, deeper_m);
    if (!gripper_bin(T_floor_grasp, wider).failed() &&
        !part_in_the_way(T_floor_grasp, wider, /*but_target=*/true).failed() &&
        !gripper_cloud(T_floor_grasp, wider).failed()) {
      return room_m;
    }
  }
  return 0;
}

Verdict CollisionScene::gripper_cloud(const Eigen::Isometry3d& T_floor_grasp,
                                      const SweptGripper& swept) const {
  if (!free_space_) return {};
  if (!is_target_out_) free_space_->take_out(parts_[target_]);
  is_target_out_ = true;
  for (const GripperBox& box : swept.boxes()) {
    if (!free_space_->is_free(box.box_m, T_floor_grasp)) return failed(box);
  }
  return passed();
}

Verdict CollisionScene::gripper_parts(const Eigen::Isometry3d& T_floor_grasp,
                                      const SweptGripper& swept) const {
  return part_in_the_way(T_floor_grasp, swept, /*but_target=*/false);
}

Verdict CollisionScene::part_in_the_way(const Eigen::Isometry3d& T_floor_grasp,
                                        const SweptGripper& swept, bool but_target) const {
  if (!is_on(Check::kGripperParts)) return {};
  const Eigen::Isometry3d T_grasp_floor = T_floor_grasp.inverse();
  for (const GripperBox& box : swept.boxes()) {
    for (std::uint32_t i = 0; i < parts_.size(); ++i) {
      if (but_target && i == target_) continue;
      const parts::Part& part = *parts_[i].part;
      // From the part that it grasps, the clearance keeps it away.
      const double margin_m = i == target_ ? 0 : parameters_.margin_m;
      Eigen::AlignedBox3d grown_m(box.box_m.min().array() - margin_m,
                                  box.box_m.max().array() + margin_m);
      const bool sits_on_it = i == target_ && gripper_.kind == GripperKind::kSuction;
      if (sits_on_it) grown_m.max().z() -= kLip_m;
      const Eigen::Vector3d half_m = grown_m.sizes() / 2;
      const Eigen::Vector3d ball_m = T_grasp_floor * barycentres_m_[i] - grown_m.center();
      if (!reaches(ball_m, part.radius_m, half_m)) continue;
      Eigen::Isometry3d T_box_part = T_grasp_floor * parts_[i].T_floor_part;
      T_box_part.pretranslate(-grown_m.center());
      const Eigen::Vector3f half = half_m.cast<float>();
      if (meets_surface({{half.x(), half.y(), half.z()}}, kernel_pose(T_box_part),
                        span_of(part.triangles))) {
        return failed(box, i);
      }
    }
  }
  return passed();
}

Verdict CollisionScene::gripper_bin(const Eigen::Isometry3d& T_floor_grasp,
                                    const SweptGripper& swept) const {
  if (!bin_ || !is_on(Check::kGripperBin)) return {};
  const auto crosses = [&](const GripperBox& box) {
    const OrientedBox in_floor(T_floor_grasp, box.box_m);
    return lowest_m(in_floor) < 0 ||
           std::ranges::any_of(walls_, [&](const auto& wall) { return overlap(in_floor, wall); });
  };
  for (const GripperBox& box : swept.boxes()) {
    if (crosses(box)) return failed(box);
  }
  // A wall between the open jaws would be gripped with the part.
  if (swept.closing() && crosses(*swept.closing())) return failed(*swept.closing());
  return passed();
}

Verdict CollisionScene::lift() const {
  if (!lifting_) return {};
  if (const auto other = lifting_->in_the_way(target_)) {
    return {CheckState::kFailed, {}, false, other};
  }
  if (bin_ && lifting_->meets_wall(target_, *bin_)) {
    return {CheckState::kFailed, {}, false, std::nullopt};
  }
  return passed();
}

std::string CollisionScene::reason(Check check, const Verdict& verdict,
                                   std::span<const std::uint32_t> ids) const {
  if (verdict.state == CheckState::kPassed) return {};
  if (!is_on(check)) return "switched off in the server's configuration";
  const bool has_failed = verdict.failed();
  switch (check) {
    case Check::kGripperCloud:
      if (!has_failed) return "there is no depth image to check against";
      return fmt::format("on its way the {} meets something, or space that was not seen",
                         verdict.culprit);
    case Check::kGripperParts:
      if (verdict.other == target_) {
        return fmt::format("the {} cuts into the part itself", verdict.culprit);
      }
      return fmt::format("on its way the {} cuts into object {}", verdict.culprit,
                         ids[*verdict.other]);
    case Check::kGripperBin:
      if (!has_failed) return "no bin was given";
      return fmt::format("on its way the {} crosses a wall or the floor of the bin",
                         verdict.culprit);
    case Check::kHeldPart:
      if (!verdict.other) return "lifted straight up, the part meets a wall of the bin";
      return fmt::format("lifted straight up, the part takes object {} with it",
                         ids[*verdict.other]);
    case Check::kOpening:
      break;
  }
  return {};
}

}  // namespace graspd::perception
