#include "read_urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

namespace graspd::motion {
namespace {

/// Where a URDF says no acceleration: slow enough for most arms.
constexpr double kDefaultAcceleration_rad_s2 = 2.0;
/// A continuous joint may turn once each way, since cables hang on real ones.
constexpr double kContinuous_rad = 2 * std::numbers::pi;

/// urdfdom says what is wrong in its log only.
class ParserLog final : public console_bridge::OutputHandler {
 public:
  ParserLog() { console_bridge::useOutputHandler(this); }
  ~ParserLog() override { console_bridge::restorePreviousOutputHandler(); }
  ParserLog(const ParserLog&) = delete;
  ParserLog& operator=(const ParserLog&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text;
  }
  const std::string& first() const { return first_; }

 private:
  std::string first_;
};

/// Debian's urdfdom is older than this attribute.
std::map<std::string, double> read_accelerations(const std::string& xml) {
  std::map<std::string, double> accelerations;
  TiXmlDocument document;
  document.Parse(xml.c_str());
  const TiXmlElement* joint = document.FirstChildElement("robot")->FirstChildElement("joint");
  for (; joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const TiXmlElement* limit = joint->FirstChildElement("limit");
    double acceleration_rad_s2 = 0;
    if (limit != nullptr &&
        limit->QueryDoubleAttribute("acceleration", &acceleration_rad_s2) == TIXML_SUCCESS) {
      accelerations[joint->Attribute("name")] = acceleration_rad_s2;
    }
  }
  return accelerations;
}

KDL::Frame to_kdl(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w),
          KDL::Vector(pose.position.x, pose.position.y, pose.position.z)};
}

/// The flange is `tool0`, by the convention of ROS-Industrial, or else the only end of the tree.
const urdf::Link* find_flange(const urdf::ModelInterface& model) {
  if (const auto tool0 = model.getLink("tool0")) return tool0.get();
  const urdf::Link* end = nullptr;
  for (const auto& [name, link] : model.links_) {
    if (!link->child_links.empty()) continue;
    if (end != nullptr) return nullptr;
    end = link.get();
  }
  return end;
}

class Reader {
 public:
  Reader(std::string file, const urdf::ModelInterface& model,
         std::map<std::string, double> accelerations)
      : file_(std::move(file)), model_(model), accelerations_(std::move(accelerations)) {}

  Result<ArmData> read() {
    const urdf::Link* const flange = find_flange(model_);
    if (flange == nullptr) {
      return invalid("{}: the arm has several ends: name the flange's link 'tool0'", file_);
    }
    for (const urdf::Link* link = flange; link != nullptr; link = link->getParent().get()) {
      chain_.insert(link);
    }
    data_.name = model_.getName();
    if (const auto ok = add(*model_.getRoot(), -1, 0); !ok) return tl::unexpected(ok.error());
    if (data_.limits.empty()) {
      return invalid("{}: no joint turns between '{}' and '{}'", file_, model_.getRoot()->name,
                     flange->name);
    }
    for (std::size_t i = 0; i < data_.links.size(); ++i) {
      if (data_.links[i].name == flange->name) data_.flange = static_cast<int>(i);
    }
    return std::move(data_);
  }

 private:
  /// The link, and all that hangs on it.
  Result<void> add(const urdf::Link& link, int parent, int joints_before_n) {
    auto segment = read_joint(link);
    if (!segment) return tl::unexpected(segment.error());
    const bool turns = segment->getJoint().getType() != KDL::Joint::Fixed;
    if (turns) ++joints_before_n;
    auto shapes = read_shapes(link);
    if (!shapes) return tl::unexpected(shapes.error());

    const int index = static_cast<int>(data_.links.size());
    data_.links.push_back({link.name, *std::move(shapes), joints_before_n});
    data_.segments.push_back(*std::move(segment));
    data_.parents.push_back(parent);
    data_.joints.push_back(turns ? joints_before_n - 1 : -1);
    for (const auto& child : link.child_links) {
      if (const auto ok = add(*child, index, joints_before_n); !ok) return ok;
    }
    return {};
  }

  Result<KDL::Segment> read_joint(const urdf::Link& link) {
    const urdf::Joint* const joint = link.parent_joint.get();
    if (joint == nullptr) return KDL::Segment(link.name, KDL::Joint(KDL::Joint::Fixed));
    const KDL::Frame T_parent_link = to_kdl(joint->parent_to_joint_origin_transform);
    if (joint->type == urdf::Joint::FIXED) {
      return KDL::Segment(link.name, KDL::Joint(joint->name, KDL::Joint::Fixed), T_parent_link);
    }
    if (joint->type != urdf::Joint::REVOLUTE && joint->type != urdf::Joint::CONTINUOUS) {
      return invalid(
          "{}: joint '{}' does not turn: only revolute, continuous and fixed joints are "
          "supported",
          file_, joint->name);
    }
    if (!chain_.contains(&link)) {
      return invalid(
          "{}: joint '{}' is not between base and flange: describe the arm alone, "
          "without a gripper's joints",
          file_, joint->name);
    }
    if (const auto ok = add_limits(*joint); !ok) return tl::unexpected(ok.error());
    const KDL::Vector axis =
        T_parent_link.M * KDL::Vector(joint->axis.x, joint->axis.y, joint->axis.z);
    return KDL::Segment(link.name,
                        KDL::Joint(joint->name, T_parent_link.p, axis, KDL::Joint::RotAxis),
                        T_parent_link);
  }

  Result<void> add_limits(const urdf::Joint& joint) {
    if (!joint.limits) {
      return invalid("{}: joint '{}' has no <limit>: say velocity, and lower and upper in radians",
                     file_, joint.name);
    }
    JointLimits limits{joint.name, joint.limits->lower, joint.limits->upper, joint.limits->velocity,
                       kDefaultAcceleration_rad_s2};
    if (joint.type == urdf::Joint::CONTINUOUS) {
      limits.min_rad = -kContinuous_rad;
      limits.max_rad = kContinuous_rad;
    }
    if (const auto it = accelerations_.find(joint.name); it != accelerations_.end()) {
      limits.max_acceleration_rad_s2 = it->second;
    }
    if (!(limits.min_rad < limits.max_rad)) {
      return invalid("{}: joint '{}' has lower limit {} and upper limit {}: lower must be less",
                     file_, joint.name, limits.min_rad, limits.max_rad);
    }
    if (!(limits.max_velocity_rad_s > 0) || !(limits.max_acceleration_rad_s2 > 0)) {
      return invalid("{}: joint '{}' has velocity {} and acceleration {}: both must be above 0",
                     file_, joint.name, limits.max_velocity_rad_s, limits.max_acceleration_rad_s2);
    }
    data_.limits.push_back(limits);
    return {};
  }

  Result<std::vector<PlacedShape>> read_shapes(const urdf::Link& link) const {
    std::vector<PlacedShape> shapes;
    for (const auto& collision : link.collision_array) {
      auto shape = read_shape(*collision->geometry, link.name);
      if (!shape) return tl::unexpected(shape.error());
      shapes.push_back({*shape, to_eigen(to_kdl(collision->origin))});
    }
    return shapes;
  }

  Result<Shape> read_shape(const urdf::Geometry& geometry, const std::string& link) const {
    switch (geometry.type) {
      case urdf::Geometry::BOX: {
        const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
        if (!(std::min({size.x, size.y, size.z}) > 0)) break;
        return Box{{size.x, size.y, size.z}};
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        if (!(std::min(cylinder.radius, cylinder.length) > 0)) break;
        return Cylinder{cylinder.radius, cylinder.length};
      }
      case urdf::Geometry::SPHERE: {
        const auto& sphere = static_cast<const urdf::Sphere&>(geometry);
        if (!(sphere.radius > 0)) break;
        return Sphere{sphere.radius};
      }
      default:
        return invalid(
            "{}: link '{}' has a mesh as collision shape: write it as boxes, cylinders "
            "and spheres",
            file_, link);
    }
    return invalid("{}: link '{}' has a collision shape without a size: all must be above 0 m",
                   file_, link);
  }

  std::string file_;
  const urdf::ModelInterface& model_;
  std::map<std::string, double> accelerations_;
  std::set<const urdf::Link*> chain_;
  ArmData data_;
};

}  // namespace

Result<ArmData> read_urdf(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return invalid("{}: can't be read", path.string());
  std::ostringstream xml;
  xml << file.rdbuf();
  const ParserLog log;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(xml.str());
  if (!model) return invalid("{}: not a URDF: {}", path.string(), log.first());
  return Reader(path.string(), *model, read_accelerations(xml.str())).read();
}

}  // namespace graspd::motion
