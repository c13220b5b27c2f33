#pragma once

#include <btBulletDynamicsCommon.h>

#include <cstddef>
#include <string>

/// What a body of the physics cell stands for, and whom it meets.
namespace graspd::sim_cell {

struct BodyLabel {
  enum class Kind { kPart, kRobot, kObstacle };
  Kind kind = Kind::kPart;
  std::string name;      ///< "jaw", "link_3", "bin"
  std::size_t part = 0;  ///< of a part: its index
};

inline const BodyLabel* label_of(const btCollisionObject* body) {
  return static_cast<const BodyLabel*>(body->getUserPointer());
}

/// Bullet's groups beside its own DefaultFilter (parts that move) and StaticFilter (the thick walls
/// that keep parts in, and that no robot knows of).
enum CollisionGroup : int {
  kMovingParts = btBroadphaseProxy::DefaultFilter,
  kFrozenParts = 1 << 8,
  kRobot = 1 << 9,
  kObstacles = 1 << 10,
};

}  // namespace graspd::sim_cell
