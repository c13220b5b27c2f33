#include "piles.hpp"

namespace graspd::bench {

sim_cell::SceneOptions pile_of(const parts::Part& part, int parts_n, double camera_height_m) {
  sim_cell::SceneOptions scene;
  scene.parts = {{part.id, parts_n}};
  scene.camera_height_m = camera_height_m;
  return scene;
}

}  // namespace graspd::bench
