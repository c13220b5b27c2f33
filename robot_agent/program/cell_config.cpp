#include "cell_config.hpp"

#include "graspd/formats/cell.hpp"
#include "graspd/formats/yaml.hpp"

namespace graspd::robot_agent {
namespace {

namespace fs = std::filesystem;

fs::path read_path(YamlMap& map, std::string_view key, const fs::path& relative_to,
                   std::string text = "") {
  map.optional(key, text);
  return text.empty() ? fs::path() : relative_to / text;
}

void read_positive(YamlMap& map, std::string_view key, double& value) {
  map.optional(key, value);
  if (value < 0) map.fault(key, fmt::format("'{}' must not be negative", key));
}

std::chrono::milliseconds read_duration(YamlMap& map, std::string_view key,
                                        std::chrono::milliseconds value) {
  double seconds = std::chrono::duration<double>(value).count();
  read_positive(map, key, seconds);
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

std::vector<RequestedPart> read_parts(YamlMap& root) {
  std::vector<RequestedPart> parts;
  for (YamlMap map : root.list_of_maps("parts")) {
    RequestedPart& part = parts.emplace_back();
    map.required("id", part.id);
    map.optional("priority", part.priority);
  }
  if (parts.empty()) root.fault("parts", "'parts' must name at least one part");
  return parts;
}

CameraConfig read_camera_section(YamlMap map, const fs::path& input) {
  CameraConfig camera;
  map.optional_enum("kind", camera.kind);
  std::string path;
  map.required("path", path);
  camera.path = input / path;
  camera.calibration = read_path(map, "calibration", input);
  map.optional("loop", camera.loop);
  map.optional("frames_n", camera.frames_n);
  read_positive(map, "period_s", camera.period_s);
  return camera;
}

PlanOptions read_options(YamlMap map) {
  PlanOptions options;
  map.optional_enum("segmentation", options.segmentation);
  map.optional_enum("registration", options.registration);
  map.optional_enum("order", options.order);
  map.optional_enum("p_system", options.p_system);
  map.optional_enum("strategy", options.strategy);
  map.optional("strategy_vector_base_m", options.strategy_vector_base_m);
  map.optional("max_grasps_n", options.max_grasps_n);
  return options;
}

agent::RetryPolicy read_retry(YamlMap map) {
  agent::RetryPolicy retry;
  std::uint32_t max_failures_n = static_cast<std::uint32_t>(retry.max_failures_n);
  map.optional("max_failures_n", max_failures_n);
  retry.max_failures_n = static_cast<int>(max_failures_n);
  retry.pause = read_duration(map, "pause_s", retry.pause);
  retry.max_pause = read_duration(map, "max_pause_s", retry.max_pause);
  return retry;
}

}  // namespace

Result<CellConfig> read_cell_config(const fs::path& path, const fs::path& output) {
  const fs::path input = fs::absolute(path).parent_path();
  CellConfig config;
  YamlDocument document(path);
  YamlMap root = document.root();
  root.required("cell", config.cell);
  root.optional("servers", config.servers);
  config.server_key = read_path(root, "server_key", input);
  config.key_file = read_path(root, "key_file", input);
  root.optional("budget_ms", config.budget_ms);
  config.parts = read_parts(root);
  config.camera = read_camera_section(root.map("camera"), input);
  if (root.has("T_base_camera")) root.required("T_base_camera", config.T_base_camera.emplace());
  if (root.has("bin")) config.bin = read_bin(root.map("bin"));
  config.gripper = read_gripper(root.map("gripper"));
  config.options = read_options(root.map("plan"));
  root.required("T_base_place", config.T_base_place);
  root.optional("failed_spot_radius_m", config.failed_spot_radius_m);
  config.retry = read_retry(root.map("retries"));
  YamlMap arm = root.map("arm");
  arm.optional_enum("kind", config.arm);
  config.arm_record = read_path(arm, "path", output, "arm.jsonl");
  config.pick_records = read_path(root, "picks", output, "picks.jsonl");
  config.overlays = read_path(root, "overlays", output);
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  return config;
}

}  // namespace graspd::robot_agent
