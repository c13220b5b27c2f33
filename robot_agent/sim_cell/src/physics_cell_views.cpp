#include <algorithm>
#include <deque>

#include "graspd/simulation/bin_mesh.hpp"
#include "physics_cell_impl.hpp"
#include "shape_mesh.hpp"

namespace graspd::sim_cell {
namespace {

constexpr simulation::Rgb kFurniture{200, 196, 188};
constexpr simulation::Rgb kArm{235, 235, 240};
constexpr simulation::Rgb kGripper{90, 95, 105};

}  // namespace

DepthFrame PhysicsCell::Impl::observe_cell() {
  const Eigen::Isometry3d T_camera_base = options.T_base_camera.inverse();
  std::vector<simulation::SceneObject> scene;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts.is_gone(i)) continue;
    scene.push_back(
        {&kinds[parts.kind(i)], T_camera_base * T_base_bin * parts.T_bin_part(i), options.gloss});
  }
  scene.push_back({&bin, T_camera_base * T_base_bin});
  const auto is_same = [](const simulation::SceneObject& a, const simulation::SceneObject& b) {
    return a.mesh == b.mesh && a.T_camera_object.matrix() == b.T_camera_object.matrix();
  };
  if (!seen || !std::ranges::equal(scene, scene_seen, is_same)) {
    const simulation::Walls walls{T_camera_base * T_base_bin, options.bin.inner_size_m};
    seen.emplace(scene, options.sensor, walls);
    scene_seen = std::move(scene);
  }
  return seen->look(options.seed + frames_n++);
}

simulation::Picture PhysicsCell::picture(const PictureView& view) const {
  const Eigen::Isometry3d T_camera_base = view.T_base_camera.inverse();
  const Eigen::Isometry3d T_camera_bin = T_camera_base * impl_->T_base_bin;
  std::vector<simulation::SceneObject> scene;
  std::vector<simulation::Rgb> colors;
  const auto draw = [&](const parts::Mesh& mesh, const Eigen::Isometry3d& T_camera_mesh,
                        simulation::Rgb color) {
    scene.push_back({&mesh, T_camera_mesh});
    colors.push_back(color);
  };
  const Bin& place = impl_->options.place;
  const parts::Mesh place_box = simulation::bin_mesh(place.inner_size_m, place.wall_thickness_m);
  draw(impl_->bin, T_camera_bin, kFurniture);
  draw(place_box, T_camera_base * place.T_base_bin, kFurniture);
  for (std::size_t i = 0; i < impl_->parts.size(); ++i) {
    if (impl_->parts.is_gone(i)) continue;
    const std::size_t kind = impl_->parts.kind(i);
    draw(impl_->kinds[kind], T_camera_bin * impl_->parts.T_bin_part(i), view.kind_colors.at(kind));
  }
  std::deque<parts::Mesh> robot;
  const auto draw_shapes = [&](const std::vector<motion::PlacedShape>& shapes,
                               simulation::Rgb color) {
    for (const motion::PlacedShape& shape : shapes) {
      draw(robot.emplace_back(mesh_of(shape.shape)), T_camera_bin * shape.T_link_shape, color);
    }
  };
  draw_shapes(impl_->links.shapes(), kArm);
  draw_shapes(impl_->gripper.shapes(), kGripper);
  return simulation::shaded(simulation::render(view.camera, scene), colors);
}

}  // namespace graspd::sim_cell
