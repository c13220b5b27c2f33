#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graspd/formats/depth_image.hpp"
#include "graspd/types/frame.hpp"
#include "graspd/types/request.hpp"

/// Scenes and results in the format of the BOP benchmark (bop.felk.cvut.cz): lengths in the files
/// are millimetres, in these structures metres.
///
///     SCENE_DIR/scene_camera.json       intrinsics, depth scale, and our extension "bin"
///     SCENE_DIR/scene_gt.json           true poses (optional)
///     SCENE_DIR/scene_gt_info.json      visible fractions (optional)
///     SCENE_DIR/depth/000000.png        16-bit
///     SCENE_DIR/instance/000000.png     our extension: 0 background, k the k-th entry of scene_gt
namespace graspd {

/// Where one part truly lies.
struct BopTruth {
  int obj_id = 0;
  Eigen::Isometry3d T_camera_part = Eigen::Isometry3d::Identity();
  double visible_fraction = 1;  ///< visible pixels / pixels without occlusion
};

/// Our extension of scene_camera.json. The bin's frame: middle of its floor, z up.
struct BopBin {
  Eigen::Isometry3d T_camera_bin = Eigen::Isometry3d::Identity();
  Eigen::Vector3d inner_size_m = Eigen::Vector3d::Zero();
};

/// One image of a scene, with what is known of it.
struct BopImage {
  int im_id = 0;
  DepthFrame frame;
  std::optional<BopBin> bin;
  std::optional<Eigen::Isometry3d> T_world_camera;  ///< from cam_R_w2c and cam_t_w2c
  std::vector<BopTruth> truth;
  std::optional<Image16> instance;
};

/// The request that an image stands for. Base is the world where the data set has one, else a base
/// above the scene whose z points against the camera's.
PlanRequest request_for(const BopImage& image, const std::vector<std::string>& part_ids);

/// A scene folder. The JSON files are read when it is opened, images one by one; safe from many
/// threads.
class BopScene {
 public:
  /// \returns INVALID_ARGUMENT where the folder, scene_camera.json or a field in it is wrong.
  static Result<BopScene> open(const std::filesystem::path& directory);

  int scene_id() const { return scene_id_; }
  const std::vector<int>& image_ids() const { return image_ids_; }
  const std::filesystem::path& directory() const { return directory_; }
  /// \returns INVALID_ARGUMENT for a number that the scene does not have, and for files that are
  /// not as BOP has them.
  Result<BopImage> read(int im_id) const;

 private:
  std::filesystem::path directory_;
  int scene_id_ = 0;
  std::vector<int> image_ids_;
  std::string camera_json_;
  std::string gt_json_;
  std::string gt_info_json_;
};

/// Writes images into a scene folder; the JSON files are complete after `finish`.
class BopSceneWriter {
 public:
  explicit BopSceneWriter(std::filesystem::path directory);
  /// Writes the image's files at once. \returns INVALID_ARGUMENT where that can't be done.
  Result<void> add(const BopImage& image);
  /// Writes the JSON files.
  Result<void> finish();

 private:
  std::filesystem::path directory_;
  std::map<int, std::string> camera_;
  std::map<int, std::string> gt_;
  std::map<int, std::string> gt_info_;
};

/// One line of a results file: a pose that was estimated.
struct BopResult {
  int scene_id = 0;
  int im_id = 0;
  int obj_id = 0;
  double score = 0;
  Eigen::Isometry3d T_camera_part = Eigen::Isometry3d::Identity();
  double time_s = 0;  ///< for the whole image, the same in each of its rows
};

/// scene_id,im_id,obj_id,score,R,t,time
Result<void> write_bop_results(const std::filesystem::path& path,
                               const std::vector<BopResult>& results);

}  // namespace graspd
