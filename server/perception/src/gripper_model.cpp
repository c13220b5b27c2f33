#include "graspd/perception/gripper_model.hpp"

namespace graspd::perception {

SweptGripper::SweptGripper(const Gripper& gripper, double opening_m, double wider_m,
                           double deeper_m)
    : standoff_m_(gripper.standoff_m), wider_m_(wider_m), deeper_m_(deeper_m) {
  const Eigen::Vector3d& jaw_m = gripper.jaw_size_m;
  const Eigen::Vector3d& palm_m = gripper.palm_size_m;
  // The palm comes first: it is the largest, and does not depend on the opening.
  add("palm", {-palm_m.x() / 2, -palm_m.y() / 2, -jaw_m.z() - palm_m.z()},
      {palm_m.x() / 2, palm_m.y() / 2, -jaw_m.z()}, false);
  if (gripper.kind == GripperKind::kSuction) {
    const double radius_m = gripper.cup_diameter_m / 2;
    add("cup", {-radius_m, -radius_m, -jaw_m.z()}, {radius_m, radius_m, 0}, false);
    return;
  }
  const double inner_m = opening_m / 2;
  const double outer_m = inner_m + jaw_m.x();
  add("jaw", {-outer_m, -jaw_m.y() / 2, -jaw_m.z()}, {-inner_m, jaw_m.y() / 2, 0}, true);
  add("jaw", {inner_m, -jaw_m.y() / 2, -jaw_m.z()}, {outer_m, jaw_m.y() / 2, 0}, true);
  closing_ = GripperBox{"jaw", boxes_[1].box_m.merged(boxes_[2].box_m), true};
}

void SweptGripper::add(std::string_view name, const Eigen::Vector3d& min_m,
                       const Eigen::Vector3d& max_m, bool moves_with_opening) {
  const Eigen::Vector3d from_m = min_m - Eigen::Vector3d(wider_m_, wider_m_, standoff_m_);
  const Eigen::Vector3d to_m = max_m + Eigen::Vector3d(wider_m_, wider_m_, deeper_m_);
  boxes_[boxes_n_++] = {name, {from_m, to_m}, moves_with_opening};
}

bool overlap(const OrientedBox& a, const OrientedBox& b) {
  const Eigen::Vector3d between_m = b.centre_m - a.centre_m;
  const auto separates = [&](const Eigen::Vector3d& axis) {
    const double reach_m = (a.axes.transpose() * axis).cwiseAbs().dot(a.half_m) +
                           (b.axes.transpose() * axis).cwiseAbs().dot(b.half_m);
    // An axis across two parallel edges is none and says nothing.
    constexpr double kRounding = 1e-12;
    return axis.squaredNorm() > kRounding && std::abs(between_m.dot(axis)) >= reach_m - kRounding;
  };
  for (int i = 0; i < 3; ++i) {
    if (separates(a.axes.col(i)) || separates(b.axes.col(i))) return false;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (separates(a.axes.col(i).cross(b.axes.col(j)))) return false;
    }
  }
  return true;
}

}  // namespace graspd::perception
