#include "graspd/formats/bop.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "graspd/formats/cell.hpp"

namespace graspd {
namespace {

using nlohmann::json;
using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor4d = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr double kMetresPerMillimetre = 1e-3;

Result<std::string> read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return invalid("{}: can't be read; is this a BOP scene folder?", path.string());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return invalid("{}: can't be written; is the disk full?", path.string());
  return {};
}

/// \throws json::exception, which the callers turn into a sentence with file and image.
template <std::size_t N>
std::array<double, N> numbers(const json& entry, const char* key) {
  auto values = entry.at(key).get<std::vector<double>>();
  if (values.size() != N) {
    throw json::other_error::create(
        501, fmt::format("'{}' has {} numbers instead of {}", key, values.size(), N), &entry);
  }
  std::array<double, N> result;
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

Eigen::Isometry3d rotation_and_mm(const json& entry, const char* R_key, const char* t_key) {
  const auto R = numbers<9>(entry, R_key);
  const auto t_mm = numbers<3>(entry, t_key);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Map<const RowMajor3d>(R.data());
  T.translation() = Eigen::Map<const Eigen::Vector3d>(t_mm.data()) * kMetresPerMillimetre;
  return T;
}

std::array<double, 9> row_major(const Eigen::Matrix3d& R) {
  std::array<double, 9> values;
  Eigen::Map<RowMajor3d>(values.data()) = R;
  return values;
}

std::array<double, 3> millimetres(const Eigen::Vector3d& p_m) {
  const Eigen::Vector3d p_mm = p_m / kMetresPerMillimetre;
  return {p_mm.x(), p_mm.y(), p_mm.z()};
}

BopBin read_bop_bin(const json& entry) {
  BopBin bin;
  const auto T = numbers<16>(entry, "T_camera_bin");
  bin.T_camera_bin.matrix() = Eigen::Map<const RowMajor4d>(T.data());
  bin.T_camera_bin.translation() *= kMetresPerMillimetre;
  const auto size_mm = numbers<3>(entry, "inner_size_mm");
  bin.inner_size_m = Eigen::Map<const Eigen::Vector3d>(size_mm.data()) * kMetresPerMillimetre;
  return bin;
}

void read_camera_entry(const json& entry, BopImage& image) {
  const auto K = numbers<9>(entry, "cam_K");
  CameraIntrinsics& camera = image.frame.camera;
  camera.fx_px = K[0];
  camera.cx_px = K[2];
  camera.fy_px = K[4];
  camera.cy_px = K[5];
  image.frame.depth_scale_m = entry.value("depth_scale", 1.0) * kMetresPerMillimetre;
  if (entry.contains("distortion")) camera.distortion = numbers<5>(entry, "distortion");
  if (entry.contains("bin")) image.bin = read_bop_bin(entry.at("bin"));
  if (entry.contains("cam_R_w2c")) {
    image.T_world_camera = rotation_and_mm(entry, "cam_R_w2c", "cam_t_w2c").inverse();
  }
}

void read_truth(const json& gt, const json& gt_info, const std::string& key, BopImage& image) {
  if (!gt.contains(key)) return;
  for (std::size_t i = 0; i < gt.at(key).size(); ++i) {
    const json& entry = gt.at(key).at(i);
    BopTruth truth;
    truth.obj_id = entry.at("obj_id").get<int>();
    truth.T_camera_part = rotation_and_mm(entry, "cam_R_m2c", "cam_t_m2c");
    if (gt_info.contains(key)) truth.visible_fraction = gt_info.at(key).at(i).at("visib_fract");
    image.truth.push_back(truth);
  }
}

std::filesystem::path image_path(const std::filesystem::path& directory, const char* folder,
                                 int im_id) {
  return directory / folder / fmt::format("{:06}.png", im_id);
}

}  // namespace

PlanRequest request_for(const BopImage& image, const std::vector<std::string>& part_ids) {
  PlanRequest request;
  request.T_base_camera = image.T_world_camera.value_or(looking_down());
  if (image.bin) {
    request.bin = Bin{request.T_base_camera * image.bin->T_camera_bin, image.bin->inner_size_m, 0};
  }
  for (const std::string& id : part_ids) request.parts.push_back({id, 0});
  return request;
}

Result<BopScene> BopScene::open(const std::filesystem::path& directory) {
  BopScene scene;
  scene.directory_ = directory;
  const auto camera_path = directory / "scene_camera.json";
  auto camera = read_text(camera_path);
  if (!camera) return tl::unexpected(camera.error());
  scene.camera_json_ = *std::move(camera);
  scene.gt_json_ = read_text(directory / "scene_gt.json").value_or("{}");
  scene.gt_info_json_ = read_text(directory / "scene_gt_info.json").value_or("{}");
  try {
    const json cameras = json::parse(scene.camera_json_);
    for (const auto& item : cameras.items()) scene.image_ids_.push_back(std::stoi(item.key()));
  } catch (const std::exception& e) {
    return invalid("{}: not as BOP has it: {}", camera_path.string(), e.what());
  }
  std::sort(scene.image_ids_.begin(), scene.image_ids_.end());
  if (scene.image_ids_.empty()) return invalid("{}: no image in it", camera_path.string());
  // BOP names scene folders by number; any other name is scene 0.
  const std::string name = std::filesystem::absolute(directory).lexically_normal().filename();
  if (!name.empty() && name.find_first_not_of("0123456789") == std::string::npos) {
    scene.scene_id_ = std::stoi(name);
  }
  return scene;
}

Result<BopImage> BopScene::read(int im_id) const {
  BopImage image;
  image.im_id = im_id;
  const std::string key = std::to_string(im_id);
  try {
    const json cameras = json::parse(camera_json_);
    if (!cameras.contains(key)) {
      return invalid("{}: no image {} in scene_camera.json", directory_.string(), im_id);
    }
    read_camera_entry(cameras.at(key), image);
    read_truth(json::parse(gt_json_), json::parse(gt_info_json_), key, image);
  } catch (const json::exception& e) {
    return invalid("{}: image {}: not as BOP has it: {}", directory_.string(), im_id, e.what());
  }
  auto depth = read_png16(image_path(directory_, "depth", im_id));
  if (!depth) return tl::unexpected(depth.error());
  image.frame.camera.width_px = depth->width_px;
  image.frame.camera.height_px = depth->height_px;
  image.frame.depth = std::move(depth->values);
  const auto instance_path = image_path(directory_, "instance", im_id);
  if (std::filesystem::exists(instance_path)) {
    auto instance = read_png16(instance_path);
    if (!instance) return tl::unexpected(instance.error());
    if (instance->values.size() != image.frame.depth.size()) {
      return invalid("{}: {} × {} pixels, but the depth image has {} × {}", instance_path.string(),
                     instance->width_px, instance->height_px, depth->width_px, depth->height_px);
    }
    image.instance = *std::move(instance);
  }
  return image;
}

BopSceneWriter::BopSceneWriter(std::filesystem::path directory)
    : directory_(std::move(directory)) {}

Result<void> BopSceneWriter::add(const BopImage& image) {
  std::error_code error;
  std::filesystem::create_directories(directory_ / "depth", error);
  if (image.instance) std::filesystem::create_directories(directory_ / "instance", error);
  const CameraIntrinsics& camera = image.frame.camera;
  const Image16 depth{camera.width_px, camera.height_px, image.frame.depth};
  if (auto ok = write_png16(image_path(directory_, "depth", image.im_id), depth); !ok) return ok;
  if (image.instance) {
    auto ok = write_png16(image_path(directory_, "instance", image.im_id), *image.instance);
    if (!ok) return ok;
  }

  json entry = {
      {"cam_K", {camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0}},
      {"depth_scale", image.frame.depth_scale_m / kMetresPerMillimetre}};
  if (camera.distortion != std::array<double, 5>{}) entry["distortion"] = camera.distortion;
  if (image.bin) {
    Eigen::Isometry3d T_mm = image.bin->T_camera_bin;
    T_mm.translation() /= kMetresPerMillimetre;
    std::array<double, 16> values;
    Eigen::Map<RowMajor4d>(values.data()) = T_mm.matrix();
    entry["bin"] = {{"T_camera_bin", values},
                    {"inner_size_mm", millimetres(image.bin->inner_size_m)}};
  }
  if (image.T_world_camera) {
    const Eigen::Isometry3d T_camera_world = image.T_world_camera->inverse();
    entry["cam_R_w2c"] = row_major(T_camera_world.linear());
    entry["cam_t_w2c"] = millimetres(T_camera_world.translation());
  }
  camera_[image.im_id] = entry.dump();

  json gt = json::array();
  json gt_info = json::array();
  for (const BopTruth& truth : image.truth) {
    gt.push_back({{"obj_id", truth.obj_id},
                  {"cam_R_m2c", row_major(truth.T_camera_part.linear())},
                  {"cam_t_m2c", millimetres(truth.T_camera_part.translation())}});
    gt_info.push_back({{"visib_fract", truth.visible_fraction}});
  }
  gt_[image.im_id] = gt.dump();
  gt_info_[image.im_id] = gt_info.dump();
  return {};
}

Result<void> BopSceneWriter::finish() {
  const std::pair<const char*, const std::map<int, std::string>*> files[] = {
      {"scene_camera.json", &camera_}, {"scene_gt.json", &gt_}, {"scene_gt_info.json", &gt_info_}};
  for (const auto& [name, entries] : files) {
    std::string text = "{";
    for (const auto& [im_id, entry] : *entries) {
      text += fmt::format("{}\n  \"{}\": {}", text.size() > 1 ? "," : "", im_id, entry);
    }
    if (auto ok = write_text(directory_ / name, text + "\n}\n"); !ok) return ok;
  }
  return {};
}

Result<void> write_bop_results(const std::filesystem::path& path,
                               const std::vector<BopResult>& results) {
  std::string text = "scene_id,im_id,obj_id,score,R,t,time\n";
  for (const BopResult& result : results) {
    const auto R = row_major(result.T_camera_part.linear());
    const auto t_mm = millimetres(result.T_camera_part.translation());
    text += fmt::format("{},{},{},{:.6f},{:.9f},{:.6f},{:.6f}\n", result.scene_id, result.im_id,
                        result.obj_id, result.score, fmt::join(R, " "), fmt::join(t_mm, " "),
                        result.time_s);
  }
  return write_text(path, text);
}

}  // namespace graspd
