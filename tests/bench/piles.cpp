#include "piles.hpp"

namespace graspd::bench {

perception::Parameters calibrated(const sim_cell::KinectV2Parameters& sensor,
                                  perception::Parameters parameters) {
  parameters.preprocess.wall_bow_m = sensor.wall_bow_m;
  parameters.preprocess.wall_reach_m = sensor.wall_reach_m;
  return parameters;
}

sim_cell::SceneOptions pile_of(const parts::Part& part, int parts_n, double camera_height_m) {
  sim_cell::SceneOptions scene;
  scene.parts = {{part.id, parts_n}};
  scene.camera_height_m = camera_height_m;
  return scene;
}

}  // namespace graspd::bench
