#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "graspd/types/request.hpp"

/// A gripper as boxes in the grasp frame: origin midway between the finger tips, or at the middle
/// of the suction cup's rim; z the approach direction; x the closing direction.
namespace graspd::perception {

/// Grasp frame.
struct GripperBox {
  std::string_view name;  ///< "palm", "jaw" or "cup"
  Eigen::AlignedBox3d box_m;
  bool moves_with_opening = false;
};

/// What the gripper takes up from pre-grasp to grasp. The approach is straight along the grasp
/// frame's z, so that what a box sweeps is a box again, and one test answers for pre-grasp, grasp
/// and all that lies between.
class SweptGripper {
 public:
  /// \param wider_m, deeper_m that all of it is larger by, to all sides and beyond the tips.
  SweptGripper(const Gripper& gripper, double opening_m, double wider_m = 0, double deeper_m = 0);

  /// Palm and jaws, or palm and cup, each swept.
  std::span<const GripperBox> boxes() const { return {boxes_.data(), boxes_n_}; }
  /// The jaws and all between them, which they cross while they close; none of a suction cup.
  const std::optional<GripperBox>& closing() const { return closing_; }

 private:
  void add(std::string_view name, const Eigen::Vector3d& min_m, const Eigen::Vector3d& max_m,
           bool moves_with_opening);

  double standoff_m_, wider_m_, deeper_m_;
  std::array<GripperBox, 3> boxes_;
  std::size_t boxes_n_ = 0;
  std::optional<GripperBox> closing_;
};

/// A box anywhere: centre, half sizes, axes as columns.
struct OrientedBox {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  OrientedBox() = default;
  OrientedBox(const Eigen::Isometry3d& T, const Eigen::AlignedBox3d& box_m)
      : centre_m(T * box_m.center()), half_m(box_m.sizes() / 2), axes(T.linear()) {}
};

/// Whether they share a volume (separating axes); faces that touch share none.
bool overlap(const OrientedBox& a, const OrientedBox& b);

}  // namespace graspd::perception
