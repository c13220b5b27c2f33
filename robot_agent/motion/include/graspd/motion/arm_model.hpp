#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "graspd/agent/joint_driver.hpp"
#include "graspd/types/result.hpp"

namespace graspd::motion {

struct JointLimits {
  std::string name;
  double min_rad = 0;
  double max_rad = 0;
  double max_velocity_rad_s = 0;
  double max_acceleration_rad_s2 = 0;
};

/// Collision primitives; each is centred in its own frame.
struct Box {
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};
struct Cylinder {
  double radius_m = 0;
  double length_m = 0;  ///< along z
};
struct Sphere {
  double radius_m = 0;
};
using Shape = std::variant<Box, Cylinder, Sphere>;

struct PlacedShape {
  Shape shape;
  Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();
};

/// What a link takes up, in its own frame.
struct LinkShape {
  std::string name;
  std::vector<PlacedShape> shapes;  ///< none where the link takes up no space
  int joints_before_n = 0;          ///< joints that move it; 0 for what stands with the base
};

struct ArmData;

/// An arm as its URDF describes it: a chain of turning joints from the root link to the flange,
/// which is the link `tool0`, or else the chain's only end. Other links may hang on it by fixed
/// joints. Cheap to copy, never changes, safe from many threads.
class ArmModel {
 public:
  /// Reads limits of acceleration from the attribute `acceleration` of `limit` (URDF 1.2).
  /// \returns INVALID_ARGUMENT naming the file, the joint or link, and what would be right.
  static Result<ArmModel> load(const std::filesystem::path& urdf);

  const std::string& name() const;
  int joints_n() const;
  /// From the base outwards.
  std::span<const JointLimits> limits() const;
  /// \param q_rad of size `joints_n`; throws otherwise. Limits are not looked at.
  Eigen::Isometry3d T_base_flange(const agent::Joints& q_rad) const;
  /// T_base_link, in the order of `links`.
  std::vector<Eigen::Isometry3d> link_poses(const agent::Joints& q_rad) const;
  /// A link comes after the one that carries it.
  std::span<const LinkShape> links() const;

  /// For what computes with the same chain.
  const ArmData& data() const { return *data_; }

 private:
  explicit ArmModel(std::shared_ptr<const ArmData> data) : data_(std::move(data)) {}

  std::shared_ptr<const ArmData> data_;
};

}  // namespace graspd::motion
