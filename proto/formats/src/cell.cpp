#include "graspd/formats/cell.hpp"

#include <fmt/ranges.h>

#include <fstream>

namespace graspd {

Eigen::Isometry3d looking_down() {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return T_base_camera;
}

namespace {

/// OpenCV writes matrices as {rows, cols, dt, data}.
std::vector<double> read_matrix(YamlMap& root, std::string_view key) {
  YamlMap map = root.map(key);
  int rows = 0;
  int cols = 0;
  std::string type;
  std::vector<double> data;
  map.required("rows", rows);
  map.required("cols", cols);
  map.optional("dt", type);
  map.required("data", data);
  if (static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols) != data.size()) {
    root.fault(key,
               fmt::format("'{}' says {} × {} but has {} numbers", key, rows, cols, data.size()));
    data.clear();
  }
  return data;
}

void read_six(YamlMap& map, std::string_view key, std::array<double, 6>& six) {
  std::vector<double> values;
  map.required(key, values);
  if (values.size() != six.size()) {
    map.fault(key, fmt::format("'{}' must be 6 numbers", key));
  } else {
    std::copy(values.begin(), values.end(), six.begin());
  }
}

DepthCorrection read_depth_correction(YamlMap map) {
  DepthCorrection correction;
  read_six(map, "offset_m", correction.offset_m);
  read_six(map, "slope", correction.slope);
  map.required("reference_m", correction.reference_m);
  map.required("min_depth_m", correction.min_depth_m);
  map.required("max_depth_m", correction.max_depth_m);
  if (correction.min_depth_m > correction.max_depth_m) {
    map.fault("min_depth_m", "'min_depth_m' must not be above 'max_depth_m'");
  }
  return correction;
}

/// As OpenCV's FileStorage writes them.
std::string matrix_yaml(std::string_view key, int rows, int cols, const std::vector<double>& data) {
  return fmt::format("{}: !!opencv-matrix\n  rows: {}\n  cols: {}\n  dt: d\n  data: [{}]\n", key,
                     rows, cols, fmt::join(data, ", "));
}

}  // namespace

Result<CameraCalibration> read_camera(const std::filesystem::path& path) {
  CameraCalibration calibration;
  YamlDocument document(path);
  YamlMap root = document.root();
  CameraIntrinsics& camera = calibration.camera;
  root.required("image_width", camera.width_px);
  root.required("image_height", camera.height_px);
  const std::vector<double> K = read_matrix(root, "camera_matrix");
  if (K.size() == 9) {
    camera.fx_px = K[0];
    camera.cx_px = K[2];
    camera.fy_px = K[4];
    camera.cy_px = K[5];
  } else if (!K.empty()) {
    root.fault("camera_matrix", "'camera_matrix' must be 3 × 3");
  }
  if (root.has("distortion_coefficients")) {
    const std::vector<double> k = read_matrix(root, "distortion_coefficients");
    if (k.size() > camera.distortion.size()) {
      root.fault("distortion_coefficients", "only k1, k2, p1, p2, k3 are supported");
    } else {
      std::copy(k.begin(), k.end(), camera.distortion.begin());
    }
  }
  for (const std::string_view informational :
       {"calibration_time", "camera_name", "avg_reprojection_error"}) {
    root.has(informational);
  }
  root.optional("depth_scale_m", calibration.depth_scale_m);
  if (root.has("T_base_camera")) {
    root.required("T_base_camera", calibration.T_base_camera.emplace());
  }
  if (root.has("depth_correction")) {
    calibration.depth_correction = read_depth_correction(root.map("depth_correction"));
  }
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  if (auto ok = validate(camera); !ok) {
    return invalid("{}: {}", path.string(), ok.error().message);
  }
  return calibration;
}

Result<void> write_camera(const std::filesystem::path& path, const CameraCalibration& calibration) {
  const CameraIntrinsics& camera = calibration.camera;
  std::ofstream file(path);
  file << fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", camera.width_px,
                      camera.height_px)
       << matrix_yaml("camera_matrix", 3, 3,
                      {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1})
       << matrix_yaml("distortion_coefficients", 1, 5,
                      {camera.distortion.begin(), camera.distortion.end()})
       << fmt::format("depth_scale_m: {}\n", calibration.depth_scale_m);
  if (const auto& pose = calibration.T_base_camera) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = pose->matrix();
    file << fmt::format("T_base_camera: [{}]\n", fmt::join(T.data(), T.data() + T.size(), ", "));
  }
  if (const auto& correction = calibration.depth_correction) {
    file << fmt::format(
        "depth_correction:\n  offset_m: [{}]\n  slope: [{}]\n  reference_m: {}\n"
        "  min_depth_m: {}\n  max_depth_m: {}\n",
        fmt::join(correction->offset_m, ", "), fmt::join(correction->slope, ", "),
        correction->reference_m, correction->min_depth_m, correction->max_depth_m);
  }
  file.flush();
  if (!file) return invalid("{}: can't be written", path.string());
  return {};
}

Bin read_bin(YamlMap map) {
  Bin bin;
  map.required("T_base_bin", bin.T_base_bin);
  map.required("inner_size_m", bin.inner_size_m);
  map.optional("wall_thickness_m", bin.wall_thickness_m);
  return bin;
}

Gripper read_gripper(YamlMap map) {
  Gripper gripper;
  map.optional_enum("kind", gripper.kind);
  map.optional("min_opening_m", gripper.min_opening_m);
  map.optional("max_opening_m", gripper.max_opening_m);
  map.optional("clearance_m", gripper.clearance_m);
  map.optional("standoff_m", gripper.standoff_m);
  map.optional("retreat_m", gripper.retreat_m);
  map.optional("jaw_size_m", gripper.jaw_size_m);
  map.optional("palm_size_m", gripper.palm_size_m);
  map.optional("cup_diameter_m", gripper.cup_diameter_m);
  return gripper;
}

Result<Cell> read_cell(const std::filesystem::path& path) {
  Cell cell;
  YamlDocument document(path);
  YamlMap root = document.root();
  if (root.has("bin")) cell.bin = read_bin(root.map("bin"));
  cell.gripper = read_gripper(root.map("gripper"));
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  return cell;
}

}  // namespace graspd
