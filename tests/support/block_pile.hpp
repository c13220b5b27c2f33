#pragma once

#include "block_scene.hpp"
#include "graspd/perception/grs.hpp"
#include "graspd/perception/organised.hpp"

namespace graspd::testing {

inline const parts::Part& bar() {
  static const parts::Part part = block_part("bar", {0.080, 0.020, 0.010});
  return part;
}

inline perception::PlacedPart bar_at(const Eigen::Vector3d& p_m, double yaw_rad = 0,
                                     double pitch_rad = 0) {
  perception::PlacedPart placed{&bar(), Eigen::Isometry3d::Identity()};
  placed.T_floor_part.translate(p_m);
  placed.T_floor_part.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()));
  return placed;
}

/// Blocks in a bin under a camera that looks straight down, as the grasp stage sees them. Base,
/// floor and bin are one frame.
struct BlockPile {
  static constexpr double kHeight_m = 0.75;

  Bin bin{Eigen::Isometry3d::Identity(), Eigen::Vector3d(0.5, 0.4, 0.15), 0.005};
  std::vector<perception::PlacedPart> parts;  ///< registered
  std::vector<Block> others;                  ///< seen, but not registered; T_camera_block in base
  perception::Scene scene;

  static Eigen::Isometry3d at(double x_m, double y_m, double z_m, double yaw_rad = 0) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Eigen::Vector3d(x_m, y_m, z_m));
    T.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    return T;
  }

  /// Fills `scene`. \param mask changes the frame before it is looked at.
  template <class Mask>
  void look(Mask mask) {
    const Eigen::Isometry3d T_base_camera = T_base_camera_above(kHeight_m);
    std::vector<Block> blocks;
    for (const perception::PlacedPart& part : parts) {
      const Eigen::AlignedBox3f box(part.part->mesh.vertices_m.front(),
                                    part.part->mesh.vertices_m.back());
      blocks.push_back({part.T_floor_part, box.sizes().cast<double>()});
    }
    blocks.insert(blocks.end(), others.begin(), others.end());
    for (Block& block : blocks)
      block.T_camera_block = T_base_camera.inverse() * block.T_camera_block;
    DepthFrame frame = render(kinect_v2(), kHeight_m, blocks);
    mask(frame);

    PlanRequest request;
    request.T_base_camera = T_base_camera;
    request.bin = bin;
    scene = {};
    scene.T_camera_floor = T_base_camera.inverse();
    scene.has_floor = true;
    scene.workspace_m = perception::requested_workspace(request, {})->kept_m();
    scene.seen = perception::seen_in_workspace(frame, request, {});
  }
  void look() {
    look([](const DepthFrame&) {});
  }
};

}  // namespace graspd::testing
