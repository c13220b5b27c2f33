#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "arm_config.hpp"
#include "graspd/agent/pick_cycle.hpp"
#include "graspd/openni2/openni2_camera.hpp"
#include "graspd/output_gripper/output_gripper.hpp"
#include "graspd/types/request.hpp"

namespace graspd::robot_agent {

enum class CameraKind { kBop, kRawlog, kOpenNi2 };

struct CameraConfig {
  CameraKind kind = CameraKind::kBop;
  std::filesystem::path calibration;  ///< empty: the recording says it
  // Of a recording.
  std::filesystem::path path;
  bool loop = false;
  std::uint32_t frames_n = 0;  ///< 0: all
  double period_s = 0;
  /// Of a real camera, but for what its calibration says.
  openni2::CameraOptions device;

  bool is_recording() const { return kind != CameraKind::kOpenNi2; }
};

/// What a cell is and does. deploy/cells/tees.yaml documents every key.
struct CellConfig {
  std::string cell;
  std::vector<std::string> servers{"tcp://127.0.0.1:5555"};
  std::filesystem::path server_key;  ///< the servers' public key; empty: they are insecure
  std::filesystem::path key_file;    ///< the cell's own key
  std::uint32_t budget_ms = 10'000;
  std::vector<RequestedPart> parts;
  std::optional<CameraConfig> camera;  ///< none: a simulated cell has its own
  /// Frames whose mean is planned on; a recording's are planned on one by one.
  std::uint32_t averaged_frames_n = 4;
  std::optional<Eigen::Isometry3d> T_base_camera;
  std::optional<Bin> bin;
  Gripper gripper;
  /// What moves the gripper; none: the arm does.
  std::optional<output_gripper::GripperOptions> gripper_output;
  PlanOptions options;
  Eigen::Isometry3d T_base_place = Eigen::Isometry3d::Identity();
  double failed_spot_radius_m = agent::Task().failed_spot_radius_m;
  agent::RetryPolicy retry;
  agent::Reactions reactions;
  agent::StirOptions stir;
  agent::DriftPolicy drift;
  ArmConfig arm;
  std::filesystem::path records;  ///< each run makes a folder in it
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
struct graspd::EnumNames<graspd::robot_agent::CameraKind> {
  using Kind = robot_agent::CameraKind;
  static constexpr std::string_view what = "kind of camera";
  static constexpr std::pair<Kind, std::string_view> values[] = {
      {Kind::kBop, "bop"}, {Kind::kRawlog, "rawlog"}, {Kind::kOpenNi2, "openni2"}};
};
