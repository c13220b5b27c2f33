#include "graspd/motion/collision_world.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "columns.hpp"
#include "fcl_shapes.hpp"

namespace graspd::motion {
namespace {

/// The server's answer, which comes in rounded numbers, may touch what it must not enter.
constexpr double kRounding_m = 0.0005;
/// Readings this near to the arm where it stood are taken for its own.
constexpr double kOwnReading_m = 0.03;
/// How far down a column goes where nobody knows of a table.
constexpr double kDeep_m = 1.0;
/// A reading this near to the table's top is the table.
constexpr double kTableReading_m = 0.01;

enum class Role { kLink, kJaw, kPalm, kPart };

/// Something that moves with a link.
struct Body {
  std::string name;
  Role role = Role::kLink;
  std::size_t link = 0;
  int joints_before_n = 0;
  Shape shape;
  Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();
  double opens_to = 0;  ///< a jaw's side along its x
  std::unique_ptr<FclObject> with_margin;
  std::unique_ptr<FclObject> tight;  ///< of the gripper
};

bool overlap(const FclObject& a, const FclObject& b) {
  if (!a.getAABB().overlap(b.getAABB())) return false;
  fcl::CollisionResultd result;
  return fcl::collide(&a, &b, fcl::CollisionRequestd(), result) > 0;
}

bool touches_any(FclObject& object, const fcl::DynamicAABBTreeCollisionManagerd& columns) {
  bool touches = false;
  columns.collide(&object, &touches, [](FclObject* a, FclObject* b, void* found) {
    return *static_cast<bool*>(found) = overlap(*a, *b);
  });
  return touches;
}

void place(FclObject& object, const Eigen::Isometry3d& T) {
  object.setTransform(T);
  object.computeAABB();
}

}  // namespace

struct CollisionWorld::Impl {
  Impl(ArmModel arm_model, const MotionParameters& of) : arm(std::move(arm_model)), parameters(of) {
    add_links();
    add_gripper();
    find_pairs();
    set_obstacles({});
  }

  void add(const std::string& name, Role role, std::size_t link, const Shape& shape,
           const Eigen::Isometry3d& T_link_shape, double opens_to = 0) {
    Body body{name,     role,
              link,     arm.links()[link].joints_before_n,
              shape,    T_link_shape,
              opens_to, std::make_unique<FclObject>(to_fcl(shape, parameters.margin_m)),
              nullptr};
    if (role == Role::kJaw || role == Role::kPalm) {
      body.tight = std::make_unique<FclObject>(to_fcl(shape, -kRounding_m));
    }
    bodies.push_back(std::move(body));
  }

  void add_links() {
    for (std::size_t i = 0; i < arm.links().size(); ++i) {
      const LinkShape& link = arm.links()[i];
      if (link.joints_before_n == arm.joints_n()) flange_link = i;
      for (const PlacedShape& placed : link.shapes) {
        add(link.name, Role::kLink, i, placed.shape, placed.T_link_shape);
      }
    }
  }

  /// On the last link that moves, by where the flange is on it.
  void add_gripper() {
    const agent::Joints zero = agent::Joints::Zero(arm.joints_n());
    const Eigen::Isometry3d T_link_grasp = arm.link_poses(zero)[flange_link].inverse() *
                                           arm.T_base_flange(zero) * parameters.T_flange_grasp;
    const auto at = [&](double x_m, double z_m) -> Eigen::Isometry3d {
      return T_link_grasp * Eigen::Translation3d(x_m, 0, z_m);
    };
    const Gripper& gripper = parameters.gripper;
    const Eigen::Vector3d& jaw_m = gripper.jaw_size_m;
    const Eigen::Vector3d& palm_m = gripper.palm_size_m;
    add("the palm", Role::kPalm, flange_link, Box{palm_m}, at(0, -jaw_m.z() - palm_m.z() / 2));
    if (gripper.kind == GripperKind::kSuction) {
      add("the cup", Role::kPalm, flange_link, Cylinder{gripper.cup_diameter_m / 2, jaw_m.z()},
          at(0, -jaw_m.z() / 2));
    } else {
      for (const double side : {-1.0, 1.0}) {
        add("a jaw", Role::kJaw, flange_link, Box{jaw_m}, at(side * jaw_m.x() / 2, -jaw_m.z() / 2),
            side);
      }
    }
    add("the held part", Role::kPart, flange_link, Sphere{parameters.held_radius_m}, T_link_grasp);
  }

  /// Of the arm's own bodies, those that could meet: not what already overlaps where the arm stands
  /// as its description draws it, and not links so few joints apart that the joints' limits, which
  /// know nothing of a gripper, keep them from each other.
  void find_pairs() {
    pose(agent::Joints::Zero(arm.joints_n()), parameters.gripper.max_opening_m);
    for (std::size_t a = 0; a < bodies.size(); ++a) {
      for (std::size_t b = a + 1; b < bodies.size(); ++b) {
        const int joints_between_n = bodies[b].joints_before_n - bodies[a].joints_before_n;
        if (joints_between_n < (bodies[b].role == Role::kLink ? 3 : 2)) continue;
        if (overlap(*bodies[a].with_margin, *bodies[b].with_margin)) continue;
        own_pairs.emplace_back(a, b);
      }
    }
  }

  void pose(const agent::Joints& q_rad, double opening_m) {
    const std::vector<Eigen::Isometry3d> T_base_link = arm.link_poses(q_rad);
    for (Body& body : bodies) {
      const Eigen::Isometry3d T = T_base_link[body.link] * body.T_link_shape *
                                  Eigen::Translation3d(body.opens_to * opening_m / 2, 0, 0);
      place(*body.with_margin, T);
      if (body.tight) place(*body.tight, T);
    }
  }

  void set_obstacles(const agent::Surroundings& around) {
    obstacles.clear();
    ground_m = parameters.table_z_m;
    if (around.bin) {
      obstacles = bin_obstacles(*around.bin, "the bin's");
      if (!ground_m) {
        ground_m = around.bin->T_base_bin.translation().z() - around.bin->wall_thickness_m;
      }
    }
    if (parameters.place_bin) {
      auto place = bin_obstacles(*parameters.place_bin, "the place bin's");
      std::ranges::move(place, std::back_inserter(obstacles));
    }
    if (ground_m) obstacles.push_back(table_obstacle(*ground_m));
  }

  void set_columns(const agent::Surroundings& around, const agent::Joints& standing_rad) {
    pose(standing_rad, parameters.gripper.max_opening_m);
    std::vector<std::pair<const Shape*, Eigen::Isometry3d>> own;  // with T_shape_base
    for (const Body& body : bodies) {
      if (body.role == Role::kPart) continue;
      own.emplace_back(&body.shape, body.with_margin->getTransform().inverse());
    }
    const auto is_own = [&](const Eigen::Vector3d& p_base_m) {
      return std::ranges::any_of(own, [&](const auto& placed) {
        return is_near(*placed.first, placed.second * p_base_m, kOwnReading_m);
      });
    };
    const auto counts = [&](const Eigen::Vector3d& p_base_m) {
      return !(ground_m && p_base_m.z() < *ground_m + kTableReading_m) && !is_own(p_base_m);
    };
    columns.clear();
    column_objects.clear();
    const double edge_m = parameters.column_m;
    for (const Column& column : columns_of(around.p_base_m, edge_m, counts)) {
      const double height_m = ground_m ? column.top_m - *ground_m : kDeep_m;
      const Eigen::Vector3d centre_m(column.centre_m.x(), column.centre_m.y(),
                                     column.top_m - height_m / 2);
      column_objects.push_back(
          std::make_unique<FclObject>(to_fcl(Box{{edge_m, edge_m, height_m}}, 0),
                                      Eigen::Isometry3d(Eigen::Translation3d(centre_m))));
    }
    std::vector<FclObject*> all;
    for (const auto& object : column_objects) all.push_back(object.get());
    columns.registerObjects(all);
    columns.setup();
  }

  bool is_checked(const Body& body, const Posture& posture) const {
    if (body.joints_before_n == 0) return false;
    return body.role != Role::kPart || (posture.holds_part && !posture.is_guided);
  }

  std::optional<std::string> touch(const Posture& posture) {
    for (Body& body : bodies) {
      if (!is_checked(body, posture)) continue;
      const bool is_trusted = posture.is_guided && body.tight != nullptr;
      FclObject& object = is_trusted ? *body.tight : *body.with_margin;
      for (const Obstacle& obstacle : obstacles) {
        if (overlap(object, *obstacle.object)) {
          return fmt::format("{} would touch {}", body.name, obstacle.name);
        }
      }
      if (!is_trusted && touches_any(object, columns)) {
        return fmt::format("{} would touch what the camera saw", body.name);
      }
    }
    for (const auto& [a, b] : own_pairs) {
      if (bodies[b].role == Role::kPart && !is_checked(bodies[b], posture)) continue;
      if (overlap(*bodies[a].with_margin, *bodies[b].with_margin)) {
        return fmt::format("{} would touch {}", bodies[b].name, bodies[a].name);
      }
    }
    return std::nullopt;
  }

  ArmModel arm;
  MotionParameters parameters;
  std::size_t flange_link = 0;  ///< one that moves as the flange does
  std::vector<Body> bodies;
  std::vector<std::pair<std::size_t, std::size_t>> own_pairs;
  std::vector<Obstacle> obstacles;
  std::optional<double> ground_m;
  std::vector<std::unique_ptr<FclObject>> column_objects;
  fcl::DynamicAABBTreeCollisionManagerd columns;
};

CollisionWorld::CollisionWorld(const ArmModel& arm, const MotionParameters& parameters)
    : impl_(std::make_unique<Impl>(arm, parameters)) {}
CollisionWorld::~CollisionWorld() = default;
CollisionWorld::CollisionWorld(CollisionWorld&&) noexcept = default;

void CollisionWorld::set_surroundings(const agent::Surroundings& surroundings,
                                      const agent::Joints& standing_rad) {
  impl_->set_obstacles(surroundings);
  impl_->set_columns(surroundings, standing_rad);
}

std::optional<std::string> CollisionWorld::touch(const agent::Joints& q_rad,
                                                 const Posture& posture) {
  impl_->pose(q_rad, posture.opening_m);
  return impl_->touch(posture);
}

}  // namespace graspd::motion
