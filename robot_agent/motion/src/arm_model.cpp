#include "graspd/motion/arm_model.hpp"

#include <stdexcept>

#include "arm_data.hpp"
#include "read_urdf.hpp"

namespace graspd::motion {

Result<ArmModel> ArmModel::load(const std::filesystem::path& urdf) {
  return read_urdf(urdf).map(
      [](ArmData&& data) { return ArmModel(std::make_shared<const ArmData>(std::move(data))); });
}

const std::string& ArmModel::name() const { return data_->name; }
int ArmModel::joints_n() const { return static_cast<int>(data_->limits.size()); }
std::span<const JointLimits> ArmModel::limits() const { return data_->limits; }
std::span<const LinkShape> ArmModel::links() const { return data_->links; }

Eigen::Isometry3d ArmModel::T_base_flange(const agent::Joints& q_rad) const {
  return link_poses(q_rad)[static_cast<std::size_t>(data_->flange)];
}

std::vector<Eigen::Isometry3d> ArmModel::link_poses(const agent::Joints& q_rad) const {
  if (q_rad.size() != joints_n()) {
    throw std::invalid_argument(
        fmt::format("{} joints for an arm of {}", q_rad.size(), joints_n()));
  }
  std::vector<Eigen::Isometry3d> T_base_link;
  T_base_link.reserve(data_->links.size());
  for (std::size_t i = 0; i < data_->links.size(); ++i) {
    const int joint = data_->joints[i];
    const KDL::Frame T_parent_link = data_->segments[i].pose(joint < 0 ? 0 : q_rad[joint]);
    const int parent = data_->parents[i];
    T_base_link.push_back(parent < 0 ? to_eigen(T_parent_link)
                                     : T_base_link[static_cast<std::size_t>(parent)] *
                                           to_eigen(T_parent_link));
  }
  return T_base_link;
}

}  // namespace graspd::motion
