#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "arm_config.hpp"
#include "graspd/agent/pick_cycle.hpp"
#include "graspd/replay/replay_camera.hpp"
#include "graspd/types/request.hpp"

namespace graspd::robot_agent {

enum class ArmKind { kRecord, kSimulated };

struct CameraConfig {
  replay::RecordingKind kind = replay::RecordingKind::kBop;
  std::filesystem::path path;
  std::filesystem::path calibration;  ///< empty: the recording says it
  bool loop = false;
  std::uint32_t frames_n = 0;  ///< 0: all
  double period_s = 0;
};

/// What a cell is and does. deploy/cells/tees.yaml documents every key.
struct CellConfig {
  std::string cell;
  std::vector<std::string> servers{"tcp://127.0.0.1:5555"};
  std::filesystem::path server_key;  ///< the servers' public key; empty: they are insecure
  std::filesystem::path key_file;    ///< the cell's own key
  std::uint32_t budget_ms = 10'000;
  std::vector<RequestedPart> parts;
  CameraConfig camera;
  std::optional<Eigen::Isometry3d> T_base_camera;
  std::optional<Bin> bin;
  Gripper gripper;
  PlanOptions options;
  Eigen::Isometry3d T_base_place = Eigen::Isometry3d::Identity();
  double failed_spot_radius_m = agent::Task().failed_spot_radius_m;
  agent::RetryPolicy retry;
  agent::Reactions reactions;
  agent::StirOptions stir;
  ArmKind arm = ArmKind::kRecord;
  std::filesystem::path arm_record;
  std::optional<MotionConfig> motion;  ///< of an arm whose motions are planned here
  std::optional<PileConfig> pile;      ///< of a simulated cell
  std::filesystem::path records;       ///< each run makes a folder in it
  bool keep_frames = true;
  std::filesystem::path overlays;  ///< empty: none are drawn
};

/// Files that are read are relative to the configuration file; files that are written are relative
/// to `output`.
/// \returns INVALID_ARGUMENT with one line per fault, each with file and line.
Result<CellConfig> read_cell_config(const std::filesystem::path& path,
                                    const std::filesystem::path& output);

}  // namespace graspd::robot_agent

template <>
struct graspd::EnumNames<graspd::robot_agent::ArmKind> {
  using Kind = robot_agent::ArmKind;
  static constexpr std::string_view what = "kind of arm";
  static constexpr std::pair<Kind, std::string_view> values[] = {{Kind::kRecord, "record"},
                                                                 {Kind::kSimulated, "simulated"}};
};
