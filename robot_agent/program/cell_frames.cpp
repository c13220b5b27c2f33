#include "cell_frames.hpp"

#include "graspd/formats/bop.hpp"
#include "graspd/formats/cell.hpp"

namespace graspd::robot_agent {
namespace {

/// The first image says it for all: the camera refuses a scene that is of more than one cell.
Result<BopImage> first_image(const std::filesystem::path& path) {
  const auto scene = BopScene::open(path);
  if (!scene) return tl::unexpected(scene.error());
  return scene->read(scene->image_ids().front());
}

}  // namespace

Result<CellFrames> find_cell_frames(const CellConfig& config) {
  CellFrames frames;
  frames.T_base_camera = looking_down();
  std::optional<BopBin> recorded_bin;
  if (config.camera && config.camera->kind == CameraKind::kBop) {
    const auto image = first_image(config.camera->path);
    if (!image) return tl::unexpected(image.error());
    if (image->T_world_camera) frames.T_base_camera = *image->T_world_camera;
    recorded_bin = image->bin;
  }
  if (config.camera && !config.camera->calibration.empty()) {
    const auto calibration = read_camera(config.camera->calibration);
    if (!calibration) return tl::unexpected(calibration.error());
    const bool is_said = calibration->T_base_camera || config.T_base_camera;
    if (config.arm.motion && !is_said) {
      return invalid(
          "{}: T_base_camera is missing, and an arm that moves needs to know where its camera "
          "stands: calibrate it with 'robot_agent calibrate', or say T_base_camera there or in the "
          "cell's file",
          config.camera->calibration.string());
    }
    frames.intrinsics = calibration->camera;
    frames.T_base_camera = calibration->T_base_camera.value_or(frames.T_base_camera);
    frames.depth_correction = calibration->depth_correction;
  }
  if (config.T_base_camera) frames.T_base_camera = *config.T_base_camera;
  if (recorded_bin) {
    frames.bin = Bin{frames.T_base_camera * recorded_bin->T_camera_bin, recorded_bin->inner_size_m};
  }
  if (config.bin) frames.bin = config.bin;
  return frames;
}

}  // namespace graspd::robot_agent
