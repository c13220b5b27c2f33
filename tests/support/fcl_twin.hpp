#pragma once

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "graspd/perception/gripper_model.hpp"
#include "graspd/perception/grs.hpp"

namespace graspd::testing {

/// The same question as CollisionScene::gripper_parts, asked of the Flexible Collision Library:
/// meshes as trees of boxes and swept spheres, and a tree over the parts.
class FclTwin {
 public:
  explicit FclTwin(std::span<const perception::PlacedPart> parts) {
    for (const perception::PlacedPart& part : parts) {
      auto& mesh = meshes_[part.part];
      if (!mesh) mesh = mesh_of(part.part->mesh);
      objects_.push_back(std::make_unique<Object>(mesh, part.T_floor_part));
      manager_.registerObject(objects_.back().get());
    }
    manager_.setup();
  }

  bool meets_a_part(const Eigen::Isometry3d& T_floor_grasp, const Eigen::AlignedBox3d& box_m,
                    std::optional<std::size_t> but = std::nullopt) {
    Object box(box_of(box_m), T_floor_grasp * Eigen::Translation3d(box_m.center()));
    Question question{but ? objects_[*but].get() : nullptr, {}};
    manager_.collide(&box, &question, [](Object* a, Object* b, void* asked) {
      auto* const of = static_cast<Question*>(asked);
      if (a == of->but || b == of->but) return false;
      return fcl::DefaultCollisionFunction<double>(a, b, &of->data);
    });
    return question.data.result.isCollision();
  }
  /// As CollisionScene::gripper_parts.
  bool meets(std::size_t target, const Eigen::Isometry3d& T_floor_grasp,
             const perception::SweptGripper& swept, double margin_m) {
    for (const auto& [name, box_m, moves] : swept.boxes()) {
      const Eigen::AlignedBox3d grown_m(box_m.min().array() - margin_m,
                                        box_m.max().array() + margin_m);
      if (meets_a_part(T_floor_grasp, grown_m, target) || meets(target, T_floor_grasp, box_m)) {
        return true;
      }
    }
    return false;
  }
  bool meets(std::size_t part, const Eigen::Isometry3d& T_floor_grasp,
             const Eigen::AlignedBox3d& box_m) const {
    const Object box(box_of(box_m), T_floor_grasp * Eigen::Translation3d(box_m.center()));
    fcl::CollisionResultd result;
    return fcl::collide(&box, objects_[part].get(), fcl::CollisionRequestd(), result) > 0;
  }

 private:
  using Object = fcl::CollisionObjectd;
  using Mesh = fcl::BVHModel<fcl::OBBRSSd>;
  struct Question {
    const Object* but;
    fcl::DefaultCollisionData<double> data;
  };

  static std::shared_ptr<Mesh> mesh_of(const parts::Mesh& mesh) {
    auto model = std::make_shared<Mesh>();
    model->beginModel();
    const auto vertex = [&](int i) -> Eigen::Vector3d {
      return mesh.vertices_m[static_cast<std::size_t>(i)].cast<double>();
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      model->addTriangle(vertex(a), vertex(b), vertex(c));
    }
    model->endModel();
    return model;
  }
  static std::shared_ptr<fcl::Boxd> box_of(const Eigen::AlignedBox3d& box_m) {
    return std::make_shared<fcl::Boxd>(box_m.sizes());
  }

  std::map<const parts::Part*, std::shared_ptr<Mesh>> meshes_;
  std::vector<std::unique_ptr<Object>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace graspd::testing
