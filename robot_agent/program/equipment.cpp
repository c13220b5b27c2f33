#include "equipment.hpp"

#include "graspd/record/recording_arm.hpp"
#include "simulated_equipment.hpp"
#include "system_clock.hpp"

namespace graspd::robot_agent {
namespace {

Result<void> add_camera(const CameraConfig& config, const CellFrames& frames,
                        Equipment& equipment) {
  replay::ReplayOptions options;
  options.loop = config.loop;
  if (config.frames_n > 0) options.max_frames_n = config.frames_n;
  options.period = std::chrono::nanoseconds(static_cast<std::int64_t>(config.period_s * 1e9));
  options.intrinsics = frames.intrinsics;
  auto camera = replay::open_recording(config.kind, config.path, options, *equipment.clock);
  if (!camera) return tl::unexpected(camera.error());
  equipment.camera = *std::move(camera);
  return {};
}

Result<void> add_recording_arm(const CellConfig& config, const CellFrames& frames,
                               Equipment& equipment) {
  auto arm = record::RecordingArm::create(config.arm_record,
                                          {config.cell, frames.T_base_camera, frames.bin});
  if (!arm) return tl::unexpected(arm.error());
  const auto robot = std::make_shared<record::RecordingArm>(*std::move(arm));
  equipment.arm = robot;
  equipment.gripper = robot;
  return {};
}

Result<void> add_robot(const CellConfig& config, const CellFrames& frames, Equipment& equipment) {
  switch (config.arm) {
    case ArmKind::kRecord:
      return add_recording_arm(config, frames, equipment);
    case ArmKind::kSimulated:
      break;  // made as a whole
  }
  throw std::logic_error("equipment: an arm of no kind");
}

}  // namespace

Result<Equipment> make_equipment(const CellConfig& config, const CellFrames& frames) {
  if (config.arm == ArmKind::kSimulated) return make_simulated_equipment(config);
  Equipment equipment;
  equipment.clock = std::make_shared<SystemClock>();
  if (auto ok = add_camera(config.camera, frames, equipment); !ok)
    return tl::unexpected(ok.error());
  if (auto ok = add_robot(config, frames, equipment); !ok) return tl::unexpected(ok.error());
  return equipment;
}

}  // namespace graspd::robot_agent
