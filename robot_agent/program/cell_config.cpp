#include "cell_config.hpp"

#include "config_values.hpp"
#include "graspd/formats/cell.hpp"
#include "graspd/types/mean_frame.hpp"

namespace graspd::robot_agent {
namespace {

namespace fs = std::filesystem;

void read_count(YamlMap& map, std::string_view key, int& value) {
  std::uint32_t count_n = static_cast<std::uint32_t>(value);
  map.optional(key, count_n);
  value = static_cast<int>(std::min(count_n, 1'000'000u));
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
  if (camera.is_recording()) {
    camera.path = require_path(map, "path", input);
    camera.calibration = read_path(map, "calibration", input);
    map.optional("loop", camera.loop);
    map.optional("frames_n", camera.frames_n);
    read_not_negative(map, "period_s", camera.period_s);
  } else {
    camera.calibration = require_path(map, "calibration", input);
    map.optional("device", camera.device.uri);
    map.optional("rate_hz", camera.device.frames_per_second);
    map.optional("mirrored", camera.device.is_mirrored);
    read_duration(map, "timeout_s", camera.device.timeout);
  }
  return camera;
}

/// A recording's frames are not of one scene that stands still.
void read_averaged_frames(YamlMap& root, CellConfig& config) {
  if (config.camera && config.camera->is_recording()) {
    if (root.has("averaged_frames_n")) {
      root.fault("averaged_frames_n",
                 "'averaged_frames_n' is for live cameras: each frame of a recording is planned on "
                 "by itself");
    }
    config.averaged_frames_n = 1;
    return;
  }
  root.optional("averaged_frames_n", config.averaged_frames_n);
  if (config.averaged_frames_n < 1 || config.averaged_frames_n > kMaxMeanFrames) {
    root.fault("averaged_frames_n",
               fmt::format("'averaged_frames_n' must be 1 to {}", kMaxMeanFrames));
  }
}

output_gripper::GripperOptions read_output(YamlMap map, const Gripper& gripper) {
  output_gripper::GripperOptions output;
  map.required("open", output.open);
  map.required("close", output.close);
  map.optional("sensor", output.sensor);
  read_duration(map, "timeout_s", output.timeout);
  read_duration(map, "settle_s", output.settle);
  output.max_opening_m = gripper.max_opening_m;
  return output;
}

void read_gripper_section(YamlMap map, CellConfig& config) {
  config.gripper = read_gripper(map);
  if (map.has("output")) config.gripper_output = read_output(map.map("output"), config.gripper);
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
  map.optional("explain_rejected", options.explain_rejected);
  return options;
}

agent::RetryPolicy read_retry(YamlMap map) {
  agent::RetryPolicy retry;
  read_count(map, "max_failures_n", retry.max_failures_n);
  read_duration(map, "pause_s", retry.pause);
  read_duration(map, "max_pause_s", retry.max_pause);
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
  read_not_negative(map, "depth_m", stir.depth_m);
  read_not_negative(map, "stroke_m", stir.stroke_m);
  map.optional("speed_share", stir.speed_share);
  if (!(stir.speed_share > 0 && stir.speed_share <= 1)) {
    map.fault("speed_share", "'speed_share' must be above 0, and at most 1");
  }
  return stir;
}

agent::DriftPolicy read_drift(YamlMap map) {
  agent::DriftPolicy drift;
  read_not_negative(map, "limit_m", drift.limit_m);
  map.optional("answers_n", drift.answers_n);
  if (drift.answers_n == 0) map.fault("answers_n", "'answers_n' must be at least 1");
  return drift;
}

/// What sections need of each other.
void check_sections(YamlMap& root, const CellConfig& config) {
  const bool camera_is_calibrated = config.camera && !config.camera->calibration.empty();
  if (config.arm.motion && !(config.bin && (config.T_base_camera || camera_is_calibrated))) {
    root.fault({},
               "an arm that moves needs to know where bin and camera stand: add the section "
               "'bin', and 'T_base_camera' or the camera's 'calibration'");
  }
  const bool has_gripper = config.arm.kind == ArmKind::kRecord || config.arm.pile;
  if (!has_gripper && !config.gripper_output) {
    root.fault({}, fmt::format("an arm of kind {} has no gripper of its own: say in "
                               "'gripper: output:' what moves it",
                               name_of(config.arm.kind)));
  }
  if (config.arm.pile && config.gripper_output) {
    root.fault("gripper", "a simulated cell has its own gripper: leave out 'output'");
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
  config.arm = read_arm(root.map("arm"), input, output);
  if (!config.arm.pile) config.camera = read_camera_section(root.map("camera"), input);
  read_averaged_frames(root, config);
  if (root.has("T_base_camera")) root.required("T_base_camera", config.T_base_camera.emplace());
  if (root.has("bin")) config.bin = read_bin(root.map("bin"));
  read_gripper_section(root.map("gripper"), config);
  config.options = read_options(root.map("plan"));
  root.required("T_base_place", config.T_base_place);
  root.optional("failed_spot_radius_m", config.failed_spot_radius_m);
  config.retry = read_retry(root.map("retries"));
  config.reactions = read_reactions(root.map("reactions"));
  config.stir = read_stir(root.map("stir"));
  config.drift = read_drift(root.map("drift_alarm"));
  config.records = read_path(root, "records", output, "records");
  root.optional("keep_frames", config.keep_frames);
  config.overlays = read_path(root, "overlays", output);
  check_sections(root, config);
  if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
  return config;
}

}  // namespace graspd::robot_agent
