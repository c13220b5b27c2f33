#include "piles.hpp"

namespace graspd::bench {

simulation::SceneOptions pile_of(const parts::Part& part, int parts_n, double camera_height_m) {
  simulation::SceneOptions scene;
  scene.parts = {{part.id, parts_n}};
  scene.camera_height_m = camera_height_m;
  return scene;
}

}  // namespace graspd::bench
