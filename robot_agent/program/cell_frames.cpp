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

Result<CellFrames> frames_of_recording(const CameraConfig& camera) {
  CellFrames frames;
  frames.T_base_camera = looking_down();
  if (camera.kind == replay::RecordingKind::kRawlog) return frames;
  const auto image = first_image(camera.path);
  if (!image) return tl::unexpected(image.error());
  if (image->T_world_camera) frames.T_base_camera = *image->T_world_camera;
  if (image->bin) {
    frames.bin = Bin{frames.T_base_camera * image->bin->T_camera_bin, image->bin->inner_size_m};
  }
  return frames;
}

}  // namespace

Result<CellFrames> find_cell_frames(const CellConfig& config) {
  auto frames = frames_of_recording(config.camera);
  if (!frames) return frames;
  const Eigen::Isometry3d T_recorded_base_camera = frames->T_base_camera;
  if (!config.camera.calibration.empty()) {
    const auto calibration = read_camera(config.camera.calibration);
    if (!calibration) return tl::unexpected(calibration.error());
    frames->intrinsics = calibration->camera;
    frames->T_base_camera = calibration->T_base_camera;
  }
  if (config.T_base_camera) frames->T_base_camera = *config.T_base_camera;
  // The scene says where the bin is from the camera, whatever base the camera stands in.
  if (frames->bin) {
    frames->bin->T_base_bin =
        frames->T_base_camera * T_recorded_base_camera.inverse() * frames->bin->T_base_bin;
  }
  if (config.bin) frames->bin = config.bin;
  return frames;
}

}  // namespace graspd::robot_agent
