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

void read_count(YamlMap& map, std::string_view key, int& value) {
  std::uint32_t count_n = static_cast<std::uint32_t>(value);
  map.optional(key, count_n);
  value = static_cast<int>(std::min(count_n, 1'000'000u));
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
  read_count(map, "max_failures_n", retry.max_failures_n);
  retry.pause = read_duration(map, "pause_s", retry.pause);
  retry.max_pause = read_duration(map, "max_pause_s", retry.max_pause);
  read_count(map, "max_old_frames_n", retry.max_old_frames_n);
  return retry;
}

void read_reaction(YamlMap& map, std::string_view key, agent::Reaction& reaction, bool may_stir) {
  map.optional_enum(key, reaction);
  if (reaction == agent::Reaction::kStir && !may_stir) {
    map.fault(key, fmt::format("'{}' can't be stir: nobody knows of a pile then", key));
  }
}

agent::Reactions read_reactions(YamlMap map) {
  agent::Reactions reactions;
  read_reaction(map, "on_bin_empty", reactions.bin_empty, /*may_stir=*/false);
  read_reaction(map, "on_bin_not_found", reactions.bin_not_found, /*may_stir=*/false);
  read_reaction(map, "on_none_registered", reactions.none_registered, /*may_stir=*/true);
  read_reaction(map, "on_all_in_collision", reactions.all_in_collision, /*may_stir=*/true);
  read_reaction(map, "on_none_reachable", reactions.none_reachable, /*may_stir=*/true);
  return reactions;
}

agent::StirOptions read_stir(YamlMap map) {
  agent::StirOptions stir;
  read_count(map, "max_in_a_row_n", stir.max_in_a_row_n);
  read_positive(map, "depth_m", stir.depth_m);
  read_positive(map, "stroke_m", stir.stroke_m);
  map.optional("speed_share", stir.speed_share);
  if (!(stir.speed_share > 0 && stir.speed_share <= 1)) {
    map.fault("speed_share", "'speed_share' must be above 0, and at most 1");
  }
  return stir;
}

void read_arm(YamlMap map, const fs::path& input, const fs::path& output, CellConfig& config) {
  map.optional_enum("kind", config.arm);
  switch (config.arm) {
    case ArmKind::kRecord:
      config.arm_record = read_path(map, "path", output, "arm.jsonl");
      break;
    case ArmKind::kSimulated:
      config.motion = read_motion(map.map("motion"), input);
      config.pile = read_pile(map.map("pile"), input, output);
      break;
  }
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
  read_arm(root.map("arm"), input, output, config);
  if (config.arm != ArmKind::kSimulated) {
    config.camera = read_camera_section(root.map("camera"), input);
  }
  if (root.has("T_base_camera")) root.required("T_base_camera", config.T_base_camera.emplace());
  if (root.has("bin")) config.bin = read_bin(root.map("bin"));
  if (config.arm == ArmKind::kSimulated && !(config.bin && config.T_base_camera)) {
    root.fault({}, "a simulated cell needs the sections 'bin' and 'T_base_camera'");
  }
  config.gripper = read_gripper(root.map("gripper"));
  config.options = read_options(root.map("plan"));
  root.required("T_base_place", config.T_base_place);
  root.optional("failed_spot_radius_m", config.failed_spot_radius_m);
  config.retry = read_retry(root.map("retries"));
  config.reactions = read_reactions(root.map("reactions"));
  config.stir = read_stir(root.map("stir"));
  config.records = read_path(root, "records", output, "records");
  root.optional("keep_frames", config.keep_frames);
  config.overlays = read_path(root, "overlays", output);
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  return config;
}

}  // namespace graspd::robot_agent
